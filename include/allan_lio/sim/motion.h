// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/math/rigid_transform.h"

namespace allan_lio {

/// The motion of the IMU at an instant.
struct MotionState {
  RigidTransform T_world_imu;
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();      ///< [m/s]
  Eigen::Vector3d acceleration_world = Eigen::Vector3d::Zero();  ///< [m/s^2]
  Eigen::Vector3d rate_imu = Eigen::Vector3d::Zero();            ///< angular rate in the IMU frame [rad/s]
};

/// A smooth motion whose derivatives are exact, so that pose, rate and acceleration agree to rounding. The z axis of
/// the world points up. Safe to ask from several threads.
class Motion {
 public:
  virtual ~Motion() = default;

  virtual double duration() const = 0;  ///< [s]

  /// `t` [s] since the start; held at the ends beyond them.
  virtual MotionState at(double t) const = 0;
};

}  // namespace allan_lio
