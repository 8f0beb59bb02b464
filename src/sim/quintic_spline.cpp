// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "quintic_spline.h"

namespace allan_lio {
namespace {

/// The uniform quintic B-spline's polynomials, times 120, by rising powers of u.
constexpr double kPolynomial[kSplineOrder][kSplineOrder] = {{1, -5, 10, -10, 5, -1},  {26, -50, 20, 20, -20, 5},
                                                            {66, 0, -60, 0, 30, -10}, {26, 50, 20, -20, -20, 10},
                                                            {1, 5, 10, 10, 5, -5},    {0, 0, 0, 0, 0, 1}};

}  // namespace

QuinticBasis quintic_basis(double u) {
  QuinticBasis basis;
  for (int i = 0; i < kSplineOrder; ++i) {
    double value = 0.0, first = 0.0, half_second = 0.0, sixth_third = 0.0;
    for (int power = kSplineOrder - 1; power >= 0; --power) {  // Horner's scheme for a polynomial and its derivatives
      sixth_third = sixth_third * u + half_second;
      half_second = half_second * u + first;
      first = first * u + value;
      value = value * u + kPolynomial[i][power];
    }
    basis.value[i] = value / 120.0;
    basis.first[i] = first / 120.0;
    basis.second[i] = 2.0 * half_second / 120.0;
    basis.third[i] = 6.0 * sixth_third / 120.0;
  }
  return basis;
}

}  // namespace allan_lio
