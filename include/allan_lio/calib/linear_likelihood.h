// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "allan_lio/calib/horizon_likelihood.h"
#include "allan_lio/calib/linear_run.h"
#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

/// How the registration errs beside what the filter reckons with. The multipliers of the IMU's noise are told apart
/// from it only if it has multipliers of its own.
struct LidarErrors {
  double white = 1.0;  ///< on the deviation of the points' noise, on top of the setting's k_r
  double view = 1.0;   ///< on the deviation of the planes in view (ViewError)
  /// The map's own error where it is being made, a random walk of the pose in the world's axes [rad/sqrt(s),
  /// m/sqrt(s)].
  double drift_rotation = 1e-5, drift_position = 1e-4;
};

struct LinearScore {
  double nll = 0.0;       ///< sum of -log p(innovation), constants included [nats]; not finite if the filter is not
  double nis = 0.0;       ///< of the same innovations
  std::uint64_t dof = 0;  ///< of the same innovations
  HorizonScore horizon;   ///< as HorizonLikelihood has it, on the linear filter's states and without kLeastGain
};

/// The Kalman filter on a linear run: its state is the error of the run's, the error of the planes in view (first-order
/// Gauss-Markov) and the map's drift, the latter two seen and estimated. Deskewing's error is correlated with the
/// state's as deskewing_error() has it.
///
/// Innovations of the first kSettling seconds, in which the map is founded, do not count in nll, nis and dof.
LinearScore score_linear(const LinearRun& run, const NoiseSetting& setting, const LidarErrors& errors,
                         bool with_horizons = true);

constexpr double kSettling = 5.0;  // [s]

}  // namespace allan_lio
