// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/propagate.h"

namespace allan_lio {

/// Carries the latest correction of a filter forward with every IMU sample, mean and covariance, by the same
/// equations as the filter.
class StatePropagator {
 public:
  struct Estimate {
    NavState state;
    NavMatrix covariance = NavMatrix::Zero();
    Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< last reading, bias taken off [rad/s], IMU frame
  };

  explicit StatePropagator(Discretization discretization) : discretization_(discretization) {}

  /// Starts again from a corrected state, and goes over the samples that came after it. `accel_scale`: factor from
  /// the readings to m/s^2.
  void restart(const NavState& state, const NavMatrix& covariance, const ImuNoise& noise, double accel_scale);

  /// Takes the next reading, as the sensor gives it. True if estimate() has moved to it: not before the first
  /// restart(), nor for a sample that is not later than the one before, not finite, or older than the state.
  bool add(const ImuSample& sample);

  /// Forgets state and samples.
  void clear();

  const Estimate& estimate() const { return estimate_; }

 private:
  ImuSample scaled(const ImuSample& sample) const;
  void step(const ImuSample& from, const ImuSample& to);

  Discretization discretization_;
  ImuNoise noise_;
  double accel_scale_ = 1.0;
  bool started_ = false;
  ImuBuffer samples_;  ///< as the sensor gives them, since the last correction
  ImuSample last_;     ///< where estimate_ stands, scaled
  Estimate estimate_;
};

}  // namespace allan_lio
