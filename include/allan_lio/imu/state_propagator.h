// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/imu_gate.h"
#include "allan_lio/imu/interval_noise.h"
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

  struct Options {
    Discretization discretization = Discretization::kTrapezoid;
    ImuRange range;
    double max_gap = std::numeric_limits<double>::infinity();  ///< longest silence that is bridged [s]
  };

  explicit StatePropagator(const Options& options) : options_(options) {}

  /// Starts again from a corrected state, and goes over the samples that came after it. `accel_scale`: factor from
  /// the readings to m/s^2; what is absurd by it is dropped, of the samples that came before too.
  void restart(const NavState& state, const NavMatrix& covariance, const ImuNoise& noise, double accel_scale);

  /// Other limits than those of the options, for the readings that come after the next restart(); what it goes over
  /// again is doubted by them already.
  void set_limits(const ImuRange& range, double max_gap) {
    options_.range = range;
    options_.max_gap = max_gap;
  }

  /// Takes the next reading, as the sensor gives it. True if estimate() has moved to it: not before the first
  /// restart(), nor for a sample that ImuGate keeps back or drops, that is not later than the one before, or older
  /// than the state. After a silence of more than `max_gap` it waits for the next restart().
  bool add(const ImuSample& sample);

  /// Forgets state and samples.
  void clear();

  const Estimate& estimate() const { return estimate_; }

  /// Between the last two samples that were taken; 0 before there are two [s].
  double sample_interval() const { return sample_interval_; }

 private:
  ImuSample scaled(const ImuSample& sample) const;
  void step(const ImuSample& from, const ImuSample& to);
  bool take(const ImuSample& sample);

  Options options_;
  ImuNoise noise_;
  double accel_scale_ = 1.0;
  bool started_ = false;
  double sample_interval_ = 0.0;  ///< [s]
  ImuGate gate_;
  ImuBuffer samples_;  ///< as the sensor gives them, since the last correction
  ImuSample last_;     ///< where estimate_ stands, scaled
  Estimate estimate_;
};

}  // namespace allan_lio
