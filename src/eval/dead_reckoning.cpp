// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/dead_reckoning.h"

#include <cmath>
#include <stdexcept>

namespace allan_lio {

Eigen::Matrix3d axial_covariance(const Eigen::Matrix3d& start, const AxialNoise& noise, double seconds) {
  const double t = seconds, t2 = t * t, t3 = t2 * t;
  Eigen::Matrix3d phi;  // the specific force is the reading less the bias
  phi << 1, t, -t2 / 2, 0, 1, -t, 0, 0, 1;
  Eigen::Matrix3d white, walk;
  white << t3 / 3, t2 / 2, 0, t2 / 2, t, 0, 0, 0, 0;
  walk << t3 * t2 / 20, t2 * t2 / 8, -t3 / 6, t2 * t2 / 8, t3 / 3, -t2 / 2, -t3 / 6, -t2 / 2, t;
  return phi * start * phi.transpose() + noise.accel_psd * white + noise.accel_bias_psd * walk;
}

Eigen::Matrix3d axial_entry_covariance(const AxialNoise& noise, double position_sigma, double interval) {
  if (!(noise.accel_psd > 0 && noise.accel_bias_psd > 0 && position_sigma > 0 && interval > 0))
    throw std::invalid_argument("the steady state at the entry needs positive noise, position sigma and interval");
  constexpr int kMostSteps = 1000000;
  constexpr double kSettled = 1e-10;  // relative change of the bias's variance in a step
  Eigen::Matrix3d p = Eigen::Vector3d(position_sigma * position_sigma, 1.0, 1.0).asDiagonal();
  for (int i = 0; i < kMostSteps; ++i) {
    const Eigen::Matrix3d predicted = axial_covariance(p, noise, interval);
    const Eigen::Vector3d gain = predicted.col(0) / (predicted(0, 0) + position_sigma * position_sigma);
    const Eigen::Matrix3d next = predicted - gain * predicted.row(0);
    const double change = std::abs(next(2, 2) - p(2, 2));
    p = 0.5 * (next + next.transpose());
    if (change < kSettled * p(2, 2)) break;
  }
  return p;
}

double portal_to_portal_sigma(const AxialNoise& noise, double position_sigma, double interval, double seconds) {
  Eigen::Matrix3d start = axial_entry_covariance(noise, position_sigma, interval);
  start.row(0).setZero();  // the position gained counts from the estimated entry
  start.col(0).setZero();
  return std::sqrt(axial_covariance(start, noise, seconds)(0, 0));
}

}  // namespace allan_lio
