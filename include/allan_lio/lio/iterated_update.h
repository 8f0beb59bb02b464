// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "allan_lio/lio/absolute_covariance.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"
#include "allan_lio/lio/point_to_plane.h"
#include "allan_lio/lio/pose_innovation.h"
#include "allan_lio/lio/view_error.h"

namespace allan_lio {

/// x (+) delta and its inverse on the estimator's whole state.
LioState lio_plus(const LioState& x, const LioVector& delta);
LioVector lio_minus(const LioState& y, const LioState& x);

/// Takes an error about x to the error about y: the inverse of d lio_minus(lio_plus(y, d), x)/dd at d = 0.
LioMatrix transport(const LioState& y, const LioState& x);

ResidualOptions residual_options(const LioConfig& config);

struct UpdateReport {
  bool applied = false;  ///< false: too few matches, state and covariance are as they were
  int iterations = 0;
  int inliers = 0;
  double residual_rms = 0.0;  ///< [m]
  Localizability localizability;
  PoseInnovation innovation;  ///< at the prediction
};

/// What the filter believes of its errors: the state's covariance, and the planes' error in view.
struct Belief {
  LioMatrix covariance = LioMatrix::Zero();  ///< of the error state, SI units of LioIndex; relative to the map
  ViewError view;
};

/// One step of the iterated EKF: the state that minimises |x (-) prior|^2_P + cost of the residuals, linearised at
/// `iterate`, as an error about `iterate`; and the covariance about it. In information form for the residuals and
/// covariance form for the prior, so that a block of P may be zero:
///   P+ = P - P E (I + L P_EE)^-1 L E^T P,  d = -J^-1 delta + P E (I + L P_EE)^-1 (g + L E^T J^-1 delta).
/// The residuals see the pose less the view's error, which is in E and keeps its covariance.
struct UpdateStep {
  LioVector step;
  Belief posterior;
  Eigen::Matrix<double, kLioDof, 6> gain;  ///< from the pose's gradient to `step`
};
UpdateStep solve_step(const LioState& iterate, const LioState& prior, const Belief& belief,
                      const NormalEquations& equations, bool estimate_extrinsics = true);

struct ScanTimes {
  double since_update;   ///< since the last update [s]
  double smeared = 0.0;  ///< the scan's duration if it was deskewed with the predicted motion [s]
};

/// Registers the points (IMU frame at the scan's end, by the state's extrinsics) to the map: moves state, belief and
/// absolute covariance to the posterior.
UpdateReport iterated_update(const std::vector<Eigen::Vector3f>& points_imu, const VoxelMap& map,
                             const LioConfig& config, const ScanTimes& times, PointToPlane& residuals, LioState& state,
                             Belief& belief, AbsoluteCovariance& absolute);

}  // namespace allan_lio
