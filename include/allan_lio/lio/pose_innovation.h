// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lio/localizability.h"

namespace allan_lio {

/// A scan's thousand residuals as one measurement of the pose, held against the prediction: y = I^-1 g with the
/// covariance I^-1 + P, in the directions that the scan supports.
struct PoseInnovation {
  int dof = 0;           ///< directions with at least half their weight
  double nis = 0.0;      ///< normalised innovation squared: chi^2 with `dof` degrees of freedom if the filter is honest
  double log_det = 0.0;  ///< of its covariance in the supported directions, in metres at the scene's scale [log m^2]
  /// Whitened by the symmetric root, in the axes of (rotation, translation): its square sums to `nis`; nothing along
  /// unsupported directions.
  PoseVector whitened = PoseVector::Zero();
};

/// `information` and `gradient` of the residuals at the prediction, unweighed; `prior` is the predicted pose's
/// covariance.
PoseInnovation pose_innovation(const PoseMatrix& information, const PoseVector& gradient, const PoseMatrix& prior,
                               const Localizability& localizability);

}  // namespace allan_lio
