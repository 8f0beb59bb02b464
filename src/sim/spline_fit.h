// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace allan_lio {

struct SplineSample {
  double knots;  ///< time since the spline's begin, in knot intervals
  Eigen::Matrix<double, 7, 1> value;
};

/// Control points (one row each, `segments` + 5) of the uniform quintic B-spline that comes closest to the samples.
/// A whisper of stiffness, the third differences of the control points, fills in where samples are missing.
Eigen::Matrix<double, Eigen::Dynamic, 7> fit_quintic_spline(const std::vector<SplineSample>& samples, int segments);

}  // namespace allan_lio
