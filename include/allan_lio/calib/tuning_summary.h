// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/calib/tuning_session.h"

namespace allan_lio {

/// What a user wants to read of a tuning that came to its end: the best setting, the settings next to it, what the data
/// tell of each coefficient, the bags before and after. In some dozen lines; what is wrong is said in words.
std::string summary_of(const TuningSession& session);

}  // namespace allan_lio
