// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// One reading in the IMU frame. The accelerometer reads specific force: +g on the up axis at rest.
struct ImuSample {
  TimeNs stamp = 0;
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< [m/s^2]
};

}  // namespace allan_lio
