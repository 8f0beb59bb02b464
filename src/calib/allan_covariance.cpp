// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/allan_covariance.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kPointsPerDecade = 300;
// Below a hundredth of the longest averaging time's frequency |H|^2 ~ f^2 leaves nothing, even of a random walk.
constexpr double kLowest = 0.01;

double square(double x) { return x * x; }

}  // namespace

double model_density(const NoiseTerms& terms, double frequency, double tau0) {
  const double omega = 2.0 * kPi * frequency;
  // A Gauss-Markov process of deviation sigma: S_b/(omega^2 + 1/T^2) with S_b = 2 sigma^2/T.
  const double markov =
      2.0 * square(terms.markov_sigma) / terms.markov_time / (square(omega) + 1.0 / square(terms.markov_time));
  return square(2.0 * terms.quantization * std::sin(kPi * frequency * tau0)) / tau0 + square(terms.white) +
         square(terms.instability) / omega + square(terms.random_walk / omega) + markov;
}

AllanCovariance::AllanCovariance(const AllanCurve& curve, double tau0) : tau0_(tau0) {
  double longest = tau0;
  for (const AllanPoint& point : curve) longest = std::max(longest, point.tau);
  const double nyquist = 0.5 / tau0, lowest = kLowest / longest;
  const auto count = static_cast<Eigen::Index>(kPointsPerDecade * std::log10(nyquist / lowest)) + 1;
  const double ratio = std::pow(nyquist / lowest, 1.0 / static_cast<double>(count));
  frequency_.resize(count);
  step_.resize(count);
  double edge = lowest;
  for (Eigen::Index l = 0; l < count; ++l, edge *= ratio) {
    frequency_[l] = edge * std::sqrt(ratio);
    step_[l] = edge * (ratio - 1.0);
  }
  response_.resize(count, static_cast<Eigen::Index>(curve.size()));
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double m = curve[i].tau / tau0, span = curve[i].slide_time;
    for (Eigen::Index l = 0; l < count; ++l) {
      const double sine = std::sin(kPi * frequency_[l] * curve[i].tau);
      response_(l, static_cast<Eigen::Index>(i)) =
          2.0 * square(square(sine)) / square(m * std::sin(kPi * frequency_[l] * tau0)) / std::sqrt(span);
    }
  }
}

Eigen::ArrayXd AllanCovariance::density(const NoiseTerms& terms) const {
  return frequency_.unaryExpr([&](double f) { return model_density(terms, f, tau0_); });
}

Eigen::MatrixXd AllanCovariance::covariance(const NoiseTerms& terms) const {
  const Eigen::MatrixXd scaled = response_.array().colwise() * (2.0 * step_.sqrt() * density(terms));
  return scaled.transpose() * scaled;
}

Eigen::VectorXd AllanCovariance::variances(const NoiseTerms& terms) const {
  const Eigen::VectorXd weight = 4.0 * step_ * density(terms).square();
  return response_.array().square().matrix().transpose() * weight;
}

AllanCovariance::Quadratic AllanCovariance::variance_of_sum(const Eigen::VectorXd& weights, const NoiseTerms& rest,
                                                            const NoiseTerms& unit) const {
  const Eigen::ArrayXd gain = 4.0 * step_ * (response_ * weights).array().square();
  const Eigen::ArrayXd of_rest = density(rest), of_unit = density(unit);
  return {(gain * of_rest.square()).sum(), 2.0 * (gain * of_rest * of_unit).sum(), (gain * of_unit.square()).sum()};
}

}  // namespace allan_lio
