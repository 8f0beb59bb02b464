// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/eval/consistency.h"

namespace allan_lio {

/// A table in plain text, and a JSON object in one line. A bound that the summary holds stands beside its stretch; in
/// JSON as "bound" and "known_tilt", null where there is none.
std::string consistency_table(const ConsistencySummary& summary);
std::string consistency_json(const ConsistencySummary& summary);

/// One line a scan: errors, sigmas and NEES, for plots and for averages over runs. Throws std::runtime_error naming the
/// path if it cannot be written.
void write_consistency_csv(const std::string& path, const ConsistencySeries& series);

/// Of such a file, what averages over runs need: columns t, support, e_along, s_along, nees_* and dof_innovation; the
/// rest may be missing. Throws std::runtime_error "file:line: sentence".
ConsistencySeries read_consistency_csv(const std::string& path);

}  // namespace allan_lio
