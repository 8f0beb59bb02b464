// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/lio/odometry.h"

namespace allan_lio {

/// Writes points as a compressed binary PCD file (x y z intensity). Throws std::runtime_error naming the file if it
/// cannot be written, or if there are no points.
void save_map(const std::string& path, const std::vector<WorldPoint>& points);

}  // namespace allan_lio
