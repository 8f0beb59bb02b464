// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// For rviz: the ellipsoid of the IMU position's 3 sigma, and a bar along every direction of the pose that the scan
/// leaves to the IMU: red one that moves, orange one that is turned about. Bars that are not needed are deleted.
visualization_msgs::MarkerArrayPtr to_markers(const LioResult& result, const std::string& odom_frame);

}  // namespace allan_lio
