// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// A plateau at an axis' largest reading: the sensor, or its driver, cuts off there.
struct Clipping {
  double at = 0.0;          ///< [rad/s] or [m/s^2]
  std::size_t samples = 0;  ///< that read just this, over all axes
};

/// What an IMU's record tells, in SI.
struct ImuReport {
  std::size_t invalid = 0;  ///< NaN, inf, above 50 g or 100 rad/s
  bool in_g = false;        ///< the readings were in g and have been taken times 9.80665
  double gravity = 0.0;     ///< mean length of the specific force, at the start's standstill if there is one [m/s^2]
  double standstill = 0.0;  ///< at the start [s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< mean rate of that standstill [rad/s]
  double gyro_noise = 0.0;     ///< N_g as the standstill's samples scatter, the worst axis [rad/s/sqrt(Hz)]
  double accel_noise = 0.0;    ///< N_a in the same way [m/s^2/sqrt(Hz)]
  double largest_rate = 0.0;   ///< of an axis [rad/s]
  double largest_accel = 0.0;  ///< of an axis [m/s^2]
  Clipping gyro_clipping, accel_clipping;
  bool frozen = false;  ///< all readings are the same

  static constexpr double kEnoughStandstill = 1.0;  ///< [s] for the figures that come from it
};

/// `samples` in the order of time, as the messages hold them: readings in g or in m/s^2.
ImuReport check_imu(std::vector<ImuSample> samples);

}  // namespace allan_lio
