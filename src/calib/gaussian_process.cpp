// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/gaussian_process.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "search_parts.h"

namespace allan_lio {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// z holds ln length..., ln (signal/unit), ln (noise/unit).
ProcessScales scales_of(const Eigen::VectorXd& z, double unit) {
  const Eigen::Index count = z.size() - 2;
  return {z.head(count).array().exp(), unit * std::exp(z[count]), unit * std::exp(z[count + 1])};
}

/// The box of z: a length shorter than the points' distances or a noise of the signal's size explains nothing.
BoxSearch scales_box(const Eigen::VectorXd& extent) {
  constexpr double kShortest = 1.0 / 30.0, kLongest = 2.0;
  constexpr double kLeastSignal = 0.2, kMostSignal = 10.0, kLeastNoise = 1e-3, kMostNoise = 1.0;
  const Eigen::Index count = extent.size();
  BoxSearch box{Eigen::VectorXd(count + 2), Eigen::VectorXd(count + 2), 0.7, 1e-3, 300};
  box.low << (kShortest * extent).array().log().matrix(), std::log(kLeastSignal), std::log(kLeastNoise);
  box.high << (kLongest * extent).array().log().matrix(), std::log(kMostSignal), std::log(kMostNoise);
  return box;
}

double deviation_of(const Eigen::VectorXd& y) {
  const double deviation = std::sqrt((y.array() - y.mean()).square().mean());
  return deviation > 0.0 ? deviation : 1.0;
}

}  // namespace

GaussianProcess::GaussianProcess(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const ProcessScales& scales)
    : x_(x), scales_(scales) {
  if (x.cols() != y.size() || x.rows() != scales.length.size() || y.size() == 0)
    throw std::invalid_argument("GaussianProcess: points, values and lengths do not fit together");
  if (!(scales.length.minCoeff() > 0.0 && scales.signal > 0.0 && scales.noise >= 0.0))
    throw std::invalid_argument("GaussianProcess: lengths and signal must be positive, the noise not negative");
  Eigen::MatrixXd matrix(y.size(), y.size());
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) matrix(i, j) = matrix(j, i) = covariance(x_.col(i), x_.col(j));
    matrix(i, i) += scales.noise * scales.noise;
  }
  root_.compute(matrix);
  if (root_.info() != Eigen::Success)
    throw std::runtime_error("GaussianProcess: the covariance is not positive definite: two points are the same");
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(y.size()), solved = root_.solve(ones);
  mean_ = solved.dot(y) / solved.dot(ones);
  residual_ = y.array() - mean_;
  weights_ = root_.solve(residual_);
}

GaussianProcess GaussianProcess::fit(const Eigen::MatrixXd& x, const Eigen::VectorXd& y,
                                     const Eigen::VectorXd& extent) {
  constexpr double kLengths[] = {0.1, 0.3, 1.0};  // of the starts, by the extent
  constexpr double kNoise = 0.03;                 // of the starts, by the deviation of y
  const double unit = deviation_of(y);
  const auto cost = [&](const Eigen::VectorXd& z) {
    return -GaussianProcess(x, y, scales_of(z, unit)).log_marginal_likelihood();
  };
  Eigen::VectorXd best;
  double lowest = std::numeric_limits<double>::infinity();
  for (const double length : kLengths) {
    Eigen::VectorXd start(extent.size() + 2);
    start << (length * extent).array().log().matrix(), 0.0, std::log(kNoise);
    const Eigen::VectorXd end = minimise(scales_box(extent), start, cost);
    const double value = cost(end);
    if (value < lowest) {
      lowest = value;
      best = end;
    }
  }
  return {x, y, scales_of(best, unit)};
}

double GaussianProcess::covariance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  const double r = std::sqrt(5.0) * (a - b).cwiseQuotient(scales_.length).norm();
  return scales_.signal * scales_.signal * (1.0 + r + r * r / 3.0) * std::exp(-r);
}

GaussianProcess::Prediction GaussianProcess::predict(const Eigen::VectorXd& x) const {
  Eigen::VectorXd shared(x_.cols());
  for (Eigen::Index i = 0; i < x_.cols(); ++i) shared[i] = covariance(x_.col(i), x);
  const double explained = root_.matrixL().solve(shared).squaredNorm();
  return {mean_ + shared.dot(weights_), std::max(0.0, scales_.signal * scales_.signal - explained)};
}

double GaussianProcess::log_marginal_likelihood() const {
  const Eigen::MatrixXd lower = root_.matrixL();
  return -0.5 * residual_.dot(weights_) - lower.diagonal().array().log().sum() -
         0.5 * static_cast<double>(residual_.size()) * std::log(kTwoPi);
}

double expected_improvement(double mean, double deviation, double best) {
  const double gain = best - mean;
  if (!(deviation > 0.0)) return std::max(0.0, gain);
  const double z = gain / deviation;
  return gain * 0.5 * std::erfc(-z / std::sqrt(2.0)) + deviation * std::exp(-0.5 * z * z) / std::sqrt(kTwoPi);
}

}  // namespace allan_lio
