// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lidar/scan.h"
#include "allan_lio/lidar/scan_downsample.h"

namespace allan_lio {

/// The scan without the points that the odometry has no use for. What is left does not depend on motion or on noise, so
/// it is chosen once for many runs. Leaves in [m]: map.insert_leaf and lidar.leaf. The downsampler is scratch space.
Scan thin_scan(const Scan& scan, double insert_leaf, double leaf, ScanDownsampler& downsampler);

/// Into how many phases the points for the update can be chosen.
constexpr std::uint32_t kThinningPhases = 8;

/// The indices of the points for the update that a start at another point of the sweep could have chosen: of each cell
/// the first among the points whose place is `phase` modulo kThinningPhases, if it has one. In order.
std::vector<std::uint32_t> registered_at_phase(const std::vector<ScanPoint>& points, double leaf, std::uint32_t phase,
                                               ScanDownsampler& downsampler);

}  // namespace allan_lio
