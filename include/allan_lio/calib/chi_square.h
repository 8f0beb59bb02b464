// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace allan_lio {

/// The quantile of the chi^2 distribution, of any positive number of degrees of freedom (exact to 1e-10 relative).
/// Throws std::invalid_argument unless 0 < probability < 1 and freedom > 0.
double chi_square_quantile(double probability, double freedom);

/// The chance that a chi^2 variable of that many degrees of freedom is below `value`.
double chi_square_probability(double value, double freedom);

struct SkewedLimits {
  double low = 0.0, high = 0.0;  ///< `high` may be infinite
};

/// 95 % limits of a non-negative x whose unbiased `estimate` has the variance constant + linear x + square x^2, the
/// last part being that of a chi^2 variable: x is inside where the estimate lies between its 2.5 % and 97.5 %
/// quantiles, those by the expansion of Cornish and Fisher (1938) with the skewness 2 square^2 x^3.
SkewedLimits skewed_limits(double estimate, double constant, double linear, double square);

}  // namespace allan_lio
