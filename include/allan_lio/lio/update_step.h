// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lio/lio_result.h"
#include "allan_lio/lio/point_to_plane.h"
#include "allan_lio/lio/scan_error.h"
#include "allan_lio/lio/view_error.h"

namespace allan_lio {

/// x (+) delta and its inverse on the estimator's whole state.
LioState lio_plus(const LioState& x, const LioVector& delta);
LioVector lio_minus(const LioState& y, const LioState& x);

/// Takes an error about x to the error about y: the inverse of d lio_minus(lio_plus(y, d), x)/dd at d = 0.
LioMatrix transport(const LioState& y, const LioState& x);

/// What the filter believes of its errors: the state's covariance, and the planes' error in view.
struct Belief {
  LioMatrix covariance = LioMatrix::Zero();  ///< of the error state, SI units of LioIndex; relative to the map
  ViewError view;
};

/// The errors beside the pose that the residuals see: the view's and the scan's together.
ViewError seen_error(const ViewError& view, const ScanError& scan);

/// Covariance of the LiDAR's pose (as one of the IMU's) relative to what the residuals see it by. `rows`:
/// lidar_pose_rows().
PoseMatrix relative_covariance(const LioMatrix& covariance, const ViewError& seen, const PoseRows& rows);

/// One step of the iterated EKF: the state that minimises |x (-) prior|^2_P + cost of the residuals, linearised at
/// `iterate`, as an error about `iterate`; and the covariance about it. In information form for the residuals and
/// covariance form for the prior, so that a block of P may be zero:
///   P+ = P - P E (I + L P_EE)^-1 L E^T P,  d = -J^-1 delta + P E (I + L P_EE)^-1 (g + L E^T J^-1 delta).
/// The residuals see the pose less the errors of the view and of the scan, whose sum is in E and keeps its covariance.
struct UpdateStep {
  LioVector step;
  Belief posterior;
  Eigen::Matrix<double, kLioDof, 6> gain;  ///< from the pose's gradient to `step`
};
UpdateStep solve_step(const LioState& iterate, const LioState& prior, const Belief& belief, const ScanError& scan,
                      const NormalEquations& equations, bool estimate_extrinsics = true);

}  // namespace allan_lio
