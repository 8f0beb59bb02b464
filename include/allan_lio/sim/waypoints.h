// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/sim/trajectory.h"

namespace allan_lio {

/// Reads a way, one waypoint a line: x, y, z [m] and, if it pleases, the speed [m/s] on the leg that leads there
/// (`speed` where there is none). Parted by commas or blanks; '#' begins a comment, a first line of words is a heading.
/// Throws std::runtime_error naming file and line.
std::vector<Waypoint> read_waypoints(const std::string& path, double speed);

}  // namespace allan_lio
