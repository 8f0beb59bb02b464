// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// The map's error where the sensor is now, as the filter itself reckons with it: the fit noise of the planes in view.
/// It stays the same as long as they are in view, so it must not be averaged away over the scans. It is never
/// corrected, but its covariance with the state is carried (a consider state; Schmidt 1966). In the coordinates of the
/// pose's error.
struct ViewError {
  /// Covariance of the state's error with this one.
  Eigen::Matrix<double, kLioDof, 6> cross = Eigen::Matrix<double, kLioDof, 6>::Zero();
  PoseMatrix own = PoseMatrix::Zero();  ///< its own: rotation, translation [rad^2, m^2]

  /// Over a time in which the view changed: a first-order Gauss-Markov process that keeps `keep` of itself and goes
  /// towards the covariance `noise`.
  void change(double keep, const PoseMatrix& noise);
};

}  // namespace allan_lio
