// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/calib/allan_fit.h"

namespace allan_lio {

/// How the estimates of one Allan variance curve scatter and how they hang together, from the power spectral density
/// of the noise: with z_i the normalised second difference of averaging time tau_i, of transfer function H_i,
///
///   sigma^2(tau_i)         = 2 Int_0^fN S |H_i|^2 df,      |H_i|^2 = 2 sin^4(pi f tau_i) / (m_i sin(pi f tau0))^2
///   cov(est_i, est_j)      = 4 / sqrt(T_i T_j)  Int_0^fN S^2 |H_i|^2 |H_j|^2 df
///
/// with S two-sided, fN = 1/(2 tau0) and T_i the time that the differences of tau_i span. The diagonal gives the
/// equivalent degrees of freedom 2 sigma^4/var of NIST SP 1065, table 5, for each power law, and what lies between.
class AllanCovariance {
 public:
  AllanCovariance(const AllanCurve& curve, double tau0);

  /// [u^4], one row and column a point.
  Eigen::MatrixXd covariance(const NoiseTerms& terms) const;

  /// The diagonal alone.
  Eigen::VectorXd variances(const NoiseTerms& terms) const;

  /// A weighted sum of the estimates has the variance constant + linear x + square x^2, x = `term_power` the squared
  /// amplitude of one term beside `rest`.
  struct Quadratic {
    double constant = 0.0, linear = 0.0, square = 0.0;
    double at(double x) const { return constant + x * (linear + x * square); }
  };
  /// `unit` is the model with that term alone at x = 1.
  Quadratic variance_of_sum(const Eigen::VectorXd& weights, const NoiseTerms& rest, const NoiseTerms& unit) const;

 private:
  Eigen::ArrayXd density(const NoiseTerms& terms) const;

  double tau0_;
  Eigen::ArrayXd frequency_;  ///< evenly spaced in the logarithm [Hz]
  Eigen::ArrayXd step_;       ///< df of each [Hz]
  Eigen::MatrixXd response_;  ///< |H_i|^2 / sqrt(T_i), one row a frequency, one column a point [1/sqrt(s)]
};

/// Two-sided power spectral density of the model at f [u^2/Hz]; `tau0` [s] is the sampling interval, by which the
/// quantisation is spread.
double model_density(const NoiseTerms& terms, double frequency, double tau0);

}  // namespace allan_lio
