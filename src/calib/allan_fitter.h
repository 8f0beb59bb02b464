// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

#include "allan_lio/calib/allan_covariance.h"

namespace allan_lio {

/// The columns of the linear model, in sigma^2: 3/tau^2, 1/tau, 2 ln2/pi, tau/3, F(tau/T)/F(lambda*).
enum Term { kQuantization, kWhite, kInstability, kRandomWalk, kMarkov };
constexpr int kTerms = 5;
constexpr double kLeastModelError = 1e-4;   ///< relative, of a variance: what is left to rounding and discretisation
using Powers = std::array<double, kTerms>;  ///< Q^2, N^2, B^2, K^2, sigma_b^2; zero where the term is absent

/// One term's sigma^2 at tau [s] for a squared amplitude of 1; `markov_time` [s] is T_b.
double allan_column(Term term, double tau, double markov_time);

NoiseTerms to_terms(const Powers& powers, double markov_time);

/// A least-squares solution of one model at one T_b.
struct Solution {
  Powers powers{};
  double cost = std::numeric_limits<double>::infinity();  ///< weighted sum of squares
};

/// Squared-amplitude estimates without the bound at zero, their covariance, and the rows that made them.
struct Linearised {
  std::vector<int> terms;  ///< the columns, -1 for the slope in ln T_b
  Eigen::VectorXd estimate;
  Eigen::MatrixXd gain;  ///< estimate = gain * variances
  Eigen::MatrixXd covariance;
};

/// Fits sums of terms to the points of one curve.
class AllanFitter {
 public:
  /// Throws std::invalid_argument if too few points can be used.
  AllanFitter(const AllanCurve& curve, double tau0, double shortest);

  AllanFit fit(const std::vector<Term>& model) const;

  /// The minimum of the fitted curve; there the slopes of its falling and rising terms cancel.
  FlatPart flat_of_flicker(const AllanFit& fit) const;

  /// Akaike's, from the Gaussian likelihood of the points.
  double criterion(const AllanFit& fit, double parameters, double model_error) const;

 private:
  static AllanCurve select(const AllanCurve& curve, double shortest);
  Eigen::VectorXd weights(const NoiseTerms& terms) const;
  double freedom_of(const std::vector<Term>& model) const;
  Solution solve(const std::vector<Term>& model, double markov_time, const Eigen::VectorXd& weight) const;
  Solution solve_subset(const std::vector<Term>& subset, double markov_time, const Eigen::VectorXd& weight) const;
  double shortest_markov_time() const;
  double search_markov_time(const std::vector<Term>& model, const Eigen::VectorXd& weight) const;
  Eigen::MatrixXd full_covariance(const NoiseTerms& terms, double model_error) const;
  double chi_square(const NoiseTerms& terms, double model_error) const;
  double find_model_error(const NoiseTerms& terms, double freedom) const;
  Linearised linearise(const std::vector<Term>& model, const NoiseTerms& terms, double model_error) const;
  Estimate interval(Term term, const Linearised& linear, const Powers& powers, const AllanFit& fit) const;
  Estimate time_interval(const Linearised& linear, double markov_time) const;

  AllanCurve points_;
  AllanCovariance scatter_;
  Eigen::VectorXd tau_, variance_;
};

}  // namespace allan_lio
