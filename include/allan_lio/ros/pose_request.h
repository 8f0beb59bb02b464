// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/PoseWithCovarianceStamped.h>

#include <Eigen/Geometry>
#include <optional>

#include "allan_lio/lio/odometry.h"

namespace allan_lio {

/// Where the IMU stands if the base stands at the requested pose. Of the requested attitude only the heading (of the
/// base's x axis) is taken; the tilt is that of `R_world_imu`, the filter's attitude, if it has one yet.
/// Throws std::runtime_error with a sentence for numbers that are not finite, a quaternion that is not of length 1, a
/// frame that is not `odom_frame`, and a covariance that is none.
PoseAnchor to_anchor(const geometry_msgs::PoseWithCovarianceStamped& request, const std::string& odom_frame,
                     const RigidTransform& T_base_imu, const std::optional<Eigen::Quaterniond>& R_world_imu);

}  // namespace allan_lio
