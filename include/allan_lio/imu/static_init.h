// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/imu/nav_state.h"

namespace allan_lio {

struct InitOptions {
  double gravity;             ///< [m/s^2]
  double gyro_still;          ///< standard deviation above which the record is of a motion [rad/s]
  double accel_still;         ///< [m/s^2]
  double velocity_sigma;      ///< [m/s]
  double moving_accel_sigma;  ///< 1 sigma of the mean acceleration when moving [m/s^2]
};

struct InitialState {
  NavState state;
  NavMatrix covariance;
};

/// True if rate and specific force vary less over the record than the options allow, and their means are what a
/// standing IMU with the specification's biases reads (within 10 sigma). A steady straight ride looks the same.
bool is_still(const std::vector<ImuSample>& record, const NoiseSpec& spec, const InitOptions& options);

/// State and covariance from the IMU alone, at the record's first stamp. The world has its origin and heading at
/// this pose and z against the measured specific force; so the pose is known exactly and what is not known of the
/// tilt stands in the gravity direction, jointly with the accelerometer's bias as one measurement of their sum
/// leaves them: f = ba - R^T g + noise, var(noise) = N_a^2/length when still. The gyro's bias, when still, is its
/// mean, var = N_g^2/length + S_bg length/3; else it is zero with the turn-on figure. The velocity is zero with
/// `velocity_sigma`. The record holds 2 samples or more, accelerations in m/s^2.
InitialState initialize(const std::vector<ImuSample>& record, bool still, const NoiseSpec& spec, const ImuNoise& noise,
                        const InitOptions& options);

/// Factor from the accelerometer's readings to m/s^2, told by the median of their lengths, which a few absurd ones do
/// not move: 1, or `gravity` for readings in g. The record must not be empty.
double detect_accel_scale(const std::vector<ImuSample>& record, double gravity);

}  // namespace allan_lio
