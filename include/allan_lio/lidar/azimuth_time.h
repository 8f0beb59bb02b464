// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// The even turn of a spinning LiDAR, as a clock for clouds without point times.
struct LidarTurn {
  bool clockwise = true;  ///< seen from above, against the LiDAR's z axis
  double duration = 0.1;  ///< of a turn [s]
};

/// Gives the scan's points times by their azimuth (atan2(y, x), LiDAR frame): the first point is at the stamp, and each
/// later one as far behind it as the head has turned since, so that a sweep whose first rays meet nothing is that much
/// too early. The points must come in the order of firing; a point may lie up to 30 degrees behind the foremost one
/// before it (lasers that look ahead). A sentence, and the times as they were, if they do not: a cloud sorted by rings
/// turns once a ring.
std::string set_times_by_azimuth(const LidarTurn& turn, Scan& scan);

}  // namespace allan_lio
