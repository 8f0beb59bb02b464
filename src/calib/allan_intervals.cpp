// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "allan_fitter.h"
#include "allan_lio/calib/chi_square.h"
#include "allan_lio/imu/imu_noise.h"

// What the fitted coefficients are worth.

namespace allan_lio {
namespace {

constexpr double kOneSided = 1.645;  ///< 95 % of the normal distribution, one-sided
constexpr double kTwoSided = 1.96;   ///< 95 %, two-sided

double square(double x) { return x * x; }

NoiseTerms unit_terms(Term term, double markov_time) {
  Powers powers{};
  powers[term] = 1.0;
  return to_terms(powers, markov_time);
}

}  // namespace

/// The solution as a linear function of the variances, with ln T_b as one more unknown where there is one.
Linearised AllanFitter::linearise(const std::vector<Term>& model, const NoiseTerms& terms, double model_error) const {
  const double markov_power = 2.0 * gauss_markov_peak_value() * square(terms.markov_sigma);
  Linearised out;
  out.terms.assign(model.begin(), model.end());
  if (markov_power > 0.0) out.terms.push_back(-1);
  const auto n = tau_.size(), k = static_cast<Eigen::Index>(out.terms.size());
  const Eigen::MatrixXd covariance = full_covariance(terms, model_error);
  const Eigen::VectorXd weight = weights(terms);
  constexpr double kStep = 1e-4;
  Eigen::MatrixXd a(n, k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const int term = out.terms[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < n; ++i) {
      const double time = terms.markov_time;
      a(i, j) = weight[i] * (term >= 0 ? allan_column(static_cast<Term>(term), tau_[i], time)
                                       : markov_power *
                                             (allan_column(kMarkov, tau_[i], time * std::exp(kStep)) -
                                              allan_column(kMarkov, tau_[i], time * std::exp(-kStep))) /
                                             (2.0 * kStep));
    }
  }
  const Eigen::VectorXd scale = a.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  const Eigen::MatrixXd inverse = (scaled.transpose() * scaled).ldlt().solve(Eigen::MatrixXd::Identity(k, k));
  out.gain = scale.asDiagonal() * inverse * scaled.transpose() * weight.asDiagonal();
  out.estimate = out.gain * variance_;
  out.covariance = out.gain * covariance * out.gain.transpose();
  return out;
}

/// 95 % limits of a squared amplitude x whose estimate has the variance a + b x + c x^2 and the skewness of the
/// chi^2 part: x is inside where the estimate lies between its own 2.5 % and 97.5 % quantiles (Cornish and Fisher).
Estimate AllanFitter::interval(Term term, const Linearised& linear, const Powers& powers, const AllanFit& fit) const {
  const double markov_time = fit.terms.markov_time;
  const auto at = std::find(linear.terms.begin(), linear.terms.end(), static_cast<int>(term));
  const auto row = static_cast<Eigen::Index>(at - linear.terms.begin());
  const Eigen::VectorXd weights = linear.gain.row(row).transpose();
  Powers rest = powers;
  rest[term] = 0.0;
  AllanCovariance::Quadratic spread =
      scatter_.variance_of_sum(weights, to_terms(rest, markov_time), unit_terms(term, markov_time));
  const double error = std::max(kLeastModelError, fit.model_error);
  for (Eigen::Index i = 0; i < tau_.size(); ++i)
    spread.constant += square(error * weights[i] * model_allan_variance(fit.terms, tau_[i]));
  const SkewedLimits limits = skewed_limits(linear.estimate[row], spread.constant, spread.linear, spread.square);
  Estimate estimate;
  estimate.value = std::sqrt(powers[term]);
  estimate.observable = powers[term] > 0.0 && linear.estimate[row] > kOneSided * std::sqrt(spread.constant);
  estimate.low = estimate.observable ? std::min(estimate.value, std::sqrt(limits.low)) : 0.0;
  // An estimate far below zero leaves no room above it; the record's own sensitivity still is a bound.
  const double sensitivity = kOneSided * std::sqrt(spread.constant);
  estimate.high = std::max(estimate.value, std::sqrt(std::max(limits.high, sensitivity)));
  return estimate;
}

Estimate AllanFitter::time_interval(const Linearised& linear, double markov_time) const {
  constexpr double kWidest = 1.0;  // [1] in ln T_b: more than a factor e is no measurement
  const Eigen::Index last = linear.covariance.rows() - 1;
  const double sigma = std::sqrt(linear.covariance(last, last));
  Estimate estimate;
  estimate.value = markov_time;
  const double longest = tau_[tau_.size() - 1] / gauss_markov_peak_lambda();
  estimate.observable = sigma < kWidest && markov_time < longest && markov_time > 1.1 * shortest_markov_time();
  if (!(sigma < 20.0)) return estimate;  // nothing is known
  estimate.low = markov_time * std::exp(-kTwoSided * sigma);
  estimate.high = markov_time * std::exp(kTwoSided * sigma);
  return estimate;
}

FlatPart AllanFitter::flat_of_flicker(const AllanFit& fit) const {
  const Powers powers = {{square(fit.terms.quantization), square(fit.terms.white), square(fit.terms.instability),
                          square(fit.terms.random_walk), 0.0}};
  const std::vector<Term> model = {kQuantization, kWhite, kInstability, kRandomWalk};
  const auto minimum = [](const Powers& p) {  // of 3 q/t^2 + n/t + k t/3, by bisection of the slope's sign
    double low = -30.0, high = 60.0;          // ln tau
    for (int i = 0; i < 200; ++i) {
      const double middle = 0.5 * (low + high), tau = std::exp(middle);
      const bool falling = 6.0 * p[kQuantization] / square(tau) + p[kWhite] / tau > p[kRandomWalk] * tau / 3.0;
      (falling ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  };
  const Linearised linear = linearise(model, fit.terms, fit.model_error);
  const double tau = minimum(powers), level = model_allan_variance(fit.terms, tau);
  const auto sample = [&](int term, double sigmas) {
    Powers moved = powers;
    const double spread = std::sqrt(linear.covariance(term, term));
    moved[term] = std::max(moved[term] * 1e-3, moved[term] + sigmas * spread);
    return std::log(minimum(moved));
  };
  FlatPart flat;
  flat.deviation.value = std::sqrt(level);
  flat.tau.value = tau;
  const double longest = tau_[tau_.size() - 1];
  flat.tau.observable = fit.random_walk.observable && tau < longest;
  flat.deviation.observable = flat.tau.observable;
  if (!flat.tau.observable) {
    // The curve still falls, or may: what was seen last bounds its floor from above and the flat part from below.
    flat.deviation.high = std::sqrt(std::max(level, model_allan_variance(fit.terms, longest)));
    flat.tau.low = flat.bias_time.low = 0.0;
    flat.bias_time.value = correlation_time_from_flat(tau);
    const double floor_level = allan_column(kInstability, 1.0, 1.0);
    constexpr double kOnTheFloor = 1.1;  // of the deviation where the curve was seen last
    if (fit.instability.observable &&
        flat.deviation.high < kOnTheFloor * std::sqrt(floor_level) * fit.instability.value) {
      // The floor itself was seen, only not where it ends.
      const double to_deviation = std::sqrt(floor_level);
      flat.deviation = {to_deviation * fit.instability.value, to_deviation * fit.instability.low,
                        to_deviation * fit.instability.high, true};
    }
    return flat;
  }
  double log_spread = 0.0;
  for (int term = 0; term < 4; ++term)
    if (powers[term] > 0.0) log_spread += square(0.5 * (sample(term, 1.0) - sample(term, -1.0)));
  Eigen::VectorXd basis(4);
  for (int term = 0; term < 4; ++term) basis[term] = allan_column(model[static_cast<std::size_t>(term)], tau, 1.0);
  const double level_spread = std::sqrt(basis.dot(linear.covariance * basis)) / level;
  const double tau_factor = std::exp(kTwoSided * std::sqrt(log_spread));
  const double level_factor = std::exp(0.5 * kTwoSided * level_spread);
  flat.deviation.low = flat.deviation.value / level_factor;
  flat.deviation.high = flat.deviation.value * level_factor;
  flat.tau.low = tau / tau_factor;
  flat.tau.high = tau * tau_factor;
  flat.bias_time = {correlation_time_from_flat(tau), correlation_time_from_flat(flat.tau.low),
                    correlation_time_from_flat(flat.tau.high), true};
  return flat;
}

}  // namespace allan_lio
