// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// Full scale of the sensor: a reading that reaches it is saturated.
struct ImuRange {
  double gyro = std::numeric_limits<double>::infinity();   ///< [rad/s]
  double accel = std::numeric_limits<double>::infinity();  ///< [m/s^2]
};

constexpr double kImuGap = 0.1;  ///< [s] between samples; what is longer is bridged with noise for what it may hide

/// Whether a reading at either end is saturated.
bool is_saturated(const ImuRange& range, const ImuSample& from, const ImuSample& to);

/// `noise`, inflated for what the straight line between two readings does not know: what a saturated sensor missed,
/// and the motion in a gap. `spacing` [s]: between the sensor's samples around the interval, which may be wider than
/// it.
ImuNoise noise_between(const ImuNoise& noise, const ImuRange& range, const ImuSample& from, const ImuSample& to,
                       double spacing);

}  // namespace allan_lio
