// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace allan_lio {

/// One axis of an IMU whose attitude is known: position, velocity and accelerometer bias along it, driven by N_a^2
/// and S_ba. The bias is a random walk, which is what a bias of T_b far longer than the stretch does.
struct AxialNoise {
  double accel_psd = 0.0;       ///< N_a^2 [(m/s^2)^2/Hz]
  double accel_bias_psd = 0.0;  ///< S_ba [(m/s^2)^2/s]
};

/// Covariance of (position, velocity, bias) after `seconds` without any measurement, from `start`, in closed form:
/// with a start of independent sigmas the position's is
/// sigma_p^2 + sigma_v^2 t^2 + sigma_b^2 t^4/4 + N_a^2 t^3/3 + S_ba t^5/20.
Eigen::Matrix3d axial_covariance(const Eigen::Matrix3d& start, const AxialNoise& noise, double seconds);

/// What is known at the entry: the steady state of a filter that has been given the position with
/// `position_sigma` [m] every `interval` [s] for long. Throws std::invalid_argument if a figure is not positive.
Eigen::Matrix3d axial_entry_covariance(const AxialNoise& noise, double position_sigma, double interval);

/// 1 sigma of the position gained from the entry to the exit of a stretch of `seconds` in which nothing is known along
/// the axis [m]: no filter can do better on the mean.
double portal_to_portal_sigma(const AxialNoise& noise, double position_sigma, double interval, double seconds);

}  // namespace allan_lio
