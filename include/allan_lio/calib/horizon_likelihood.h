// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// Times over which a state is carried on by the IMU alone [s].
constexpr std::array<double, 3> kHorizons = {3.0, 10.0, 30.0};

/// How a run's states agree with what the IMU alone made of earlier ones.
struct HorizonScore {
  double nll = 0.0;                ///< weighed sum of -log p(error) [nats]
  double nis = 0.0;                ///< weighed sum of the errors' normalised squares
  double dof = 0.0;                ///< weighed number of the errors' components: those of horizons that do not overlap
  double independent_share = 1.0;  ///< how much less they say than so many independent ones, see below
};

/// The negative log-likelihood of dead reckoning. A scan's state is carried on over a horizon T by the readings alone,
/// mean and covariance, and held against the state of the scan at its end; so the noise of the IMU is judged over the
/// times in which a scene without support needs it, by the directions that are supported.
///
/// The difference e of an estimate and of the same filter's prediction, whatever measurements lie between, has the
/// covariance P_predicted - P_estimate, since an optimal estimate's error is uncorrelated with what it was corrected by
/// (Anderson and Moore 1979, section 5.3). Of e the pose counts, in the directions that the last scan supports, in
/// metres at the scene's scale and as a rate, e/T [m/s]: a prediction that is good to 1 m/s scores 0, and so does a
/// direction without support. Where the estimate knows hardly more than the prediction their difference is what the
/// filter's approximations leave of it: at least kLeastGain of P_predicted is taken.
///
/// Horizons begin every T/4, and each weighs a quarter.
class HorizonLikelihood {
 public:
  explicit HorizonLikelihood(const LioConfig& config) : config_(config) {}

  /// The states of a run, one after the other. Horizons begin where a standstill that was held ended.
  void add(const LioResult& result);

  /// `imu`: what the run was given, in any order; `accel_scale`: factor from the readings to m/s^2. An error that is
  /// not finite or costs more counts kWorstHorizonNll; no horizon in the run: all zero.
  ///
  /// The independent share compares how much nis - m dof, m being nis per dof of the run, varies between stretches of
  /// the longest horizon with how much it would if all errors were independent: at most 1, and 1 if there are
  /// fewer than kFewestStretches.
  HorizonScore score(const std::vector<ImuSample>& imu, double accel_scale) const;

  static constexpr double kLeastGain = 0.25;
  static constexpr double kWorstHorizonNll = 1e5;
  static constexpr std::size_t kFewestStretches = 4;

 private:
  struct Entry {
    NavState nav;
    InertialMatrix covariance;
    Localizability localizability;
    PoseVector relocated;
    bool updated;
  };

  LioConfig config_;
  std::vector<Entry> entries_;
};

}  // namespace allan_lio
