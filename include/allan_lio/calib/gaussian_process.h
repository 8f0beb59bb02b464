// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace allan_lio {

/// The hyper-parameters of a Gaussian process.
struct ProcessScales {
  Eigen::VectorXd length;  ///< per coordinate, in its unit
  double signal = 1.0;     ///< 1 sigma of the function, in the unit of its values
  double noise = 0.0;      ///< 1 sigma of an observation's error, likewise
};

/// Regression of y = f(x) + noise, f a Gaussian process with a constant mean, which is estimated by generalised least
/// squares, and the Matern 5/2 covariance signal^2 (1 + r + r^2/3) exp(-r), r = sqrt(5) |diff(x)/length|
/// (Rasmussen and Williams 2006, equations 2.25, 2.26, 4.17 and 5.8).
class GaussianProcess {
 public:
  /// `x` holds a point a column. Throws std::invalid_argument if sizes do not fit or a scale is not positive (the
  /// noise may be zero), std::runtime_error if the covariance is not positive definite.
  GaussianProcess(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const ProcessScales& scales);

  /// The scales of the largest marginal likelihood, found by BOBYQA from several starts within bounds: lengths from a
  /// thirtieth to twice the extent `high - low`, signal and noise by the deviation of y.
  static GaussianProcess fit(const Eigen::MatrixXd& x, const Eigen::VectorXd& y, const Eigen::VectorXd& extent);

  struct Prediction {
    double mean = 0.0;
    double variance = 0.0;  ///< of f, without an observation's noise and the error of the constant mean
  };
  Prediction predict(const Eigen::VectorXd& x) const;

  double log_marginal_likelihood() const;
  double mean() const { return mean_; }
  const ProcessScales& scales() const { return scales_; }

 private:
  double covariance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

  Eigen::MatrixXd x_;
  ProcessScales scales_;
  Eigen::LLT<Eigen::MatrixXd> root_;  // of K + noise^2 I
  double mean_ = 0.0;
  Eigen::VectorXd residual_, weights_;  // y - mean, (K + noise^2 I)^-1 (y - mean)
};

/// E max(0, best - f) of a normal f: by how much it is expected to be lower than `best` (Jones, Schonlau and Welch
/// 1998, equation 15).
double expected_improvement(double mean, double deviation, double best);

}  // namespace allan_lio
