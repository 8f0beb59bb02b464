// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/calib/horizon_likelihood.h"
#include "allan_lio/calib/noise_trial_run.h"

namespace allan_lio {

/// A run as its states come in.
class RunScore {
 public:
  /// `reference` (may be empty) must outlive it.
  RunScore(const Trajectory& reference, const LioConfig& config);

  void add(const LioResult& result);
  bool diverged() const { return result_.diverged; }

  /// `fed`: scans that the odometry was given, `imu` its samples, `accel_scale` what it found them to be in.
  TrialResult finish(const LioCounters& counters, std::uint64_t fed, const std::vector<ImuSample>& imu,
                     double accel_scale);

 private:
  void measure();

  const Trajectory& reference_;
  const double farthest_;  ///< [m]
  TrialResult result_;
  Trajectory estimate_;
  HorizonLikelihood horizons_;
};

}  // namespace allan_lio
