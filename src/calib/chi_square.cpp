// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/chi_square.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr double kTwoSided = 1.959963984540054;  ///< 97.5 % of the normal distribution

/// The regularised lower incomplete gamma function P(a, x), by its series where it converges fast and else by the
/// continued fraction of its complement (Abramowitz and Stegun 6.5.29, 6.5.31).
double incomplete_gamma(double a, double x) {
  if (x <= 0.0) return 0.0;
  constexpr int kMost = 100000;
  constexpr double kEnough = 1e-16;
  int sign = 0;  // std::lgamma would keep it in a global, which two threads must not write
  const double front = std::exp(a * std::log(x) - x - lgamma_r(a, &sign));
  if (x < a + 1.0) {
    double term = 1.0 / a, sum = term;
    for (int n = 1; n < kMost && term > kEnough * sum; ++n) sum += term *= x / (a + n);
    return front * sum;
  }
  double b = x + 1.0 - a, c = 1e300, d = 1.0 / b, fraction = d;
  for (int n = 1; n < kMost; ++n) {
    const double an = -n * (n - a);
    b += 2.0;
    d = 1.0 / (an * d + b);
    c = b + an / c;
    const double step = c * d;
    fraction *= step;
    if (std::abs(step - 1.0) < kEnough) break;
  }
  return 1.0 - front * fraction;
}

double quantile(double x, double z, double constant, double linear, double square) {
  const double variance = constant + x * (linear + x * square);
  if (variance <= 0.0) return x;
  const double sigma = std::sqrt(variance);
  const double skewness = 2.0 * square * square * x * x * x / (variance * sigma);
  return x + sigma * (z + skewness * (z * z - 1.0) / 6.0);
}

}  // namespace

double chi_square_probability(double value, double freedom) { return incomplete_gamma(0.5 * freedom, 0.5 * value); }

double chi_square_quantile(double probability, double freedom) {
  if (!(probability > 0.0 && probability < 1.0 && freedom > 0.0))
    throw std::invalid_argument("chi_square_quantile: needs 0 < probability < 1 and freedom > 0");
  double low = 0.0, high = freedom + 10.0;
  while (chi_square_probability(high, freedom) < probability) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square_probability(middle, freedom) < probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

SkewedLimits skewed_limits(double estimate, double constant, double linear, double square) {
  constexpr double kFarthest = 1e6;  // times the scale of the estimate: past it nothing bounds x
  const auto above = [&](double x) { return quantile(x, -kTwoSided, constant, linear, square) > estimate; };
  const auto below = [&](double x) { return quantile(x, kTwoSided, constant, linear, square) < estimate; };
  const double scale = std::max(std::abs(estimate), std::sqrt(std::max(0.0, constant)));
  const auto bisect = [&](double inside, double outside, const auto& is_outside) {
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (inside + outside);
      (is_outside(middle) ? outside : inside) = middle;
    }
    return 0.5 * (inside + outside);
  };
  SkewedLimits limits;
  const double start = std::max(0.0, estimate);
  double far = start + scale;
  while (!above(far) && far < kFarthest * scale) far = start + 2.0 * (far - start);
  limits.high = above(far) ? bisect(start, far, above) : std::numeric_limits<double>::infinity();
  limits.low = below(0.0) ? bisect(start, 0.0, below) : 0.0;
  return limits;
}

}  // namespace allan_lio
