// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "allan_lio/imu/imu_noise.h"

namespace allan_lio {

/// What is tuned: the multipliers of the IMU's noise (paper, section on tuning) and of the noise of the LiDAR's points.
struct NoiseSetting {
  NoiseScale imu;    ///< k_g, k_a, k_gb, k_ab
  double k_r = 1.0;  ///< on a point's noise
};

/// One run of the filter: a bag, a setting, and which of the repeated runs.
struct NoiseTrial {
  std::uint32_t bag = 0;  ///< number of the bag in the problem
  NoiseSetting setting;
  std::uint32_t run = 0;  ///< 0: the bag as it is; from 1 on perturbed, seeded by the search's seed, bag and run
};

/// What a run gave.
struct TrialResult {
  double ate = std::numeric_limits<double>::quiet_NaN();  ///< RMSE of position after SE(3) alignment [m]; NaN: no truth
  double end_error =
      std::numeric_limits<double>::quiet_NaN();  ///< position, first poses laid together [m]; NaN: no truth
  double nll = 0.0;           ///< sum over the scans of -log p(innovation), constants included; finite even if diverged
  double nis = 0.0;           ///< sum of the innovations' normalised squares
  std::uint64_t nis_dof = 0;  ///< and of their degrees of freedom
  double horizon_nll = 0.0;   ///< of what the IMU alone predicts over seconds (HorizonScore); finite even if diverged
  double horizon_nis = 0.0, horizon_dof = 0.0;  ///< of the same
  double horizon_share = 1.0;                   ///< of the same: HorizonScore::independent_share
  std::uint32_t scans = 0;                      ///< processed
  bool diverged = false;  ///< lost its map, went to infinity, or used fewer than half of the scans
};

/// Runs trials, in any order and in parallel; results come in the trials' order. Throws std::runtime_error if the
/// engine itself fails: a diverged run is a result.
using RunTrials = std::function<std::vector<TrialResult>(const std::vector<NoiseTrial>&)>;

}  // namespace allan_lio
