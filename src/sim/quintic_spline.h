// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace allan_lio {

constexpr int kSplineOrder = 6;  ///< control points that one segment of a quintic spline depends on

/// Weights of the six control points at a place of a segment, with their derivatives.
struct QuinticBasis {
  double value[kSplineOrder], first[kSplineOrder], second[kSplineOrder], third[kSplineOrder];
};

/// The uniform quintic B-spline (C^4) at `u` in [0, 1] of a segment; the derivatives are by u.
QuinticBasis quintic_basis(double u);

}  // namespace allan_lio
