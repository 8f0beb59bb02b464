// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_fitter.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "allan_lio/imu/imu_noise.h"

namespace allan_lio {
namespace {

constexpr double kLn2 = 0.69314718055994530942;
constexpr double kPi = 3.14159265358979323846;
constexpr double kLongest = 0.2;    ///< averaging times up to this share of the record are fitted
constexpr std::size_t kFewest = 6;  ///< points
constexpr double kTrust = 0.005;    ///< no variance weighs more than if it were known to this share
constexpr int kReweightings = 4;

double square(double x) { return x * x; }

/// The model without the terms that the bound holds at zero and that would be below it by more than their scatter.
std::vector<Term> without_negative(const std::vector<Term>& model, const Linearised& linear, const Powers& powers) {
  constexpr double kOneSided = 1.645;
  std::vector<Term> left;
  for (std::size_t j = 0; j < model.size(); ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    const bool negative = linear.estimate[row] < -kOneSided * std::sqrt(linear.covariance(row, row));
    if (powers[model[j]] > 0.0 || !negative) left.push_back(model[j]);
  }
  return left;
}

}  // namespace

double allan_column(Term term, double tau, double markov_time) {
  switch (term) {
    case kQuantization:
      return 3.0 / square(tau);
    case kWhite:
      return 1.0 / tau;
    case kInstability:
      return 2.0 * kLn2 / kPi;
    case kRandomWalk:
      return tau / 3.0;
    case kMarkov:
      return gauss_markov_allan_shape(tau / markov_time) / gauss_markov_peak_value();
  }
  return 0.0;
}

/// sigma_b^2 = F(lambda*) S_b T and S_b = 2 sigma^2/T.
NoiseTerms to_terms(const Powers& powers, double markov_time) {
  NoiseTerms terms;
  terms.quantization = std::sqrt(powers[kQuantization]);
  terms.white = std::sqrt(powers[kWhite]);
  terms.instability = std::sqrt(powers[kInstability]);
  terms.random_walk = std::sqrt(powers[kRandomWalk]);
  terms.markov_sigma = std::sqrt(powers[kMarkov] / (2.0 * gauss_markov_peak_value()));
  terms.markov_time = markov_time;
  return terms;
}

AllanFitter::AllanFitter(const AllanCurve& curve, double tau0, double shortest)
    : points_(select(curve, shortest)), scatter_(points_, tau0) {
  const auto n = static_cast<Eigen::Index>(points_.size());
  tau_.resize(n);
  variance_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    tau_[i] = points_[static_cast<std::size_t>(i)].tau;
    variance_[i] = points_[static_cast<std::size_t>(i)].variance;
  }
}

AllanCurve AllanFitter::select(const AllanCurve& curve, double shortest) {
  double record = 0.0;
  for (const AllanPoint& point : curve) record = std::max(record, point.record_time);
  AllanCurve points;
  for (const AllanPoint& point : curve) {
    if (!(point.variance >= 0.0) || !std::isfinite(point.variance))
      throw std::invalid_argument("the Allan variance at " + std::to_string(point.tau) + " s is not finite");
    const bool inside = point.tau >= shortest * (1.0 - 1e-9) && point.tau <= kLongest * record;
    if (inside && point.variance > 0.0) points.push_back(point);
  }
  if (points.size() < kFewest)
    throw std::invalid_argument("the record is too short or constant: only " + std::to_string(points.size()) +
                                " points of the Allan deviation can be used, " + std::to_string(kFewest) +
                                " are needed");
  return points;
}

/// One over the standard deviation that the equivalent degrees of freedom give each variance.
Eigen::VectorXd AllanFitter::weights(const NoiseTerms& terms) const {
  Eigen::VectorXd weight = scatter_.variances(terms);
  for (Eigen::Index i = 0; i < tau_.size(); ++i)
    weight[i] = 1.0 / std::sqrt(weight[i] + square(kTrust * model_allan_variance(terms, tau_[i])));
  return weight;
}

double AllanFitter::freedom_of(const std::vector<Term>& model) const {
  const bool markov = std::find(model.begin(), model.end(), kMarkov) != model.end();
  return std::max(1.0, static_cast<double>(tau_.size()) - static_cast<double>(model.size()) - (markov ? 1.0 : 0.0));
}

Solution AllanFitter::solve_subset(const std::vector<Term>& subset, double markov_time,
                                   const Eigen::VectorXd& weight) const {
  const auto n = tau_.size(), k = static_cast<Eigen::Index>(subset.size());
  Eigen::MatrixXd a(n, k);
  for (Eigen::Index j = 0; j < k; ++j)
    for (Eigen::Index i = 0; i < n; ++i) a(i, j) = weight[i] * allan_column(subset[j], tau_[i], markov_time);
  const Eigen::VectorXd b = weight.cwiseProduct(variance_);
  const Eigen::VectorXd scale = a.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = a * scale.asDiagonal();
  const Eigen::VectorXd x = scaled.colPivHouseholderQr().solve(b).cwiseProduct(scale);
  Solution solution;
  if (!x.allFinite() || (k > 0 && x.minCoeff() < 0.0)) return solution;
  for (Eigen::Index j = 0; j < k; ++j) solution.powers[subset[static_cast<std::size_t>(j)]] = x[j];
  solution.cost = (a * x - b).squaredNorm();
  return solution;
}

/// Non-negative least squares: with at most five columns every active set can be tried.
Solution AllanFitter::solve(const std::vector<Term>& model, double markov_time, const Eigen::VectorXd& weight) const {
  Solution best;
  for (unsigned mask = 1; mask < (1u << model.size()); ++mask) {
    std::vector<Term> subset;
    for (std::size_t j = 0; j < model.size(); ++j)
      if (mask & (1u << j)) subset.push_back(model[j]);
    const Solution solution = solve_subset(subset, markov_time, weight);
    if (solution.cost < best.cost) best = solution;
  }
  return best;
}

/// What forgets itself within a second is vibration or a filter's ringing, not a bias that an estimator can follow.
double AllanFitter::shortest_markov_time() const { return std::max(1.0, 3.0 * tau_[0]); }

/// The T_b of least cost: a grid over all times that the curve can show, then golden sections.
double AllanFitter::search_markov_time(const std::vector<Term>& model, const Eigen::VectorXd& weight) const {
  constexpr int kGrid = 60, kSections = 40;
  constexpr double kGolden = 0.61803398874989484820;
  const double low = std::log(shortest_markov_time()), high = std::log(2.0 * tau_[tau_.size() - 1]);
  const auto cost = [&](double log_time) { return solve(model, std::exp(log_time), weight).cost; };
  const double step = (high - low) / kGrid;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kGrid; ++i) {
    const double now = cost(low + i * step);
    if (now < least) least = now, best = i;
  }
  double left = std::max(low, low + (best - 1) * step), right = std::min(high, low + (best + 1) * step);
  double a = right - kGolden * (right - left), b = left + kGolden * (right - left);
  double cost_a = cost(a), cost_b = cost(b);
  for (int i = 0; i < kSections; ++i) {
    if (cost_a < cost_b) {
      right = b, b = a, cost_b = cost_a, a = right - kGolden * (right - left), cost_a = cost(a);
    } else {
      left = a, a = b, cost_a = cost_b, b = left + kGolden * (right - left), cost_b = cost(b);
    }
  }
  return std::exp(0.5 * (left + right));
}

Eigen::MatrixXd AllanFitter::full_covariance(const NoiseTerms& terms, double model_error) const {
  Eigen::MatrixXd covariance = scatter_.covariance(terms);
  for (Eigen::Index i = 0; i < tau_.size(); ++i)
    covariance(i, i) += square(std::max(kLeastModelError, model_error) * model_allan_variance(terms, tau_[i]));
  return covariance;
}

double AllanFitter::chi_square(const NoiseTerms& terms, double model_error) const {
  Eigen::VectorXd residual = variance_;
  for (Eigen::Index i = 0; i < tau_.size(); ++i) residual[i] -= model_allan_variance(terms, tau_[i]);
  return residual.dot(full_covariance(terms, model_error).ldlt().solve(residual));
}

/// The relative error of the model, independent from point to point, that brings chi^2 down to its degrees of
/// freedom (as DerSimonian and Laird 1986 do between studies); 0 if it is there without.
double AllanFitter::find_model_error(const NoiseTerms& terms, double freedom) const {
  if (chi_square(terms, 0.0) <= freedom) return 0.0;
  double low = std::log(kLeastModelError), high = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    (chi_square(terms, std::exp(middle)) > freedom ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

AllanFit AllanFitter::fit(const std::vector<Term>& model) const {
  const bool markov = std::find(model.begin(), model.end(), kMarkov) != model.end();
  Eigen::VectorXd weight = variance_.cwiseInverse().cwiseProduct(tau_.cwiseSqrt().cwiseInverse());
  AllanFit fit;
  Solution solution;
  double time = 1.0;
  for (int pass = 0; pass < kReweightings; ++pass) {
    if (markov) time = search_markov_time(model, weight);
    solution = solve(model, time, weight);
    fit.terms = to_terms(solution.powers, time);
    weight = weights(fit.terms);
  }
  const double freedom = freedom_of(model);
  fit.misfit = chi_square(fit.terms, 0.0) / freedom;
  fit.model_error = find_model_error(fit.terms, freedom);
  Linearised linear = linearise(model, fit.terms, fit.model_error);
  Estimate* const estimates[kTerms] = {&fit.quantization, &fit.white, &fit.instability, &fit.random_walk,
                                       &fit.markov_flat};
  for (const Term term : model) *estimates[term] = interval(term, linear, solution.powers, fit);
  // A term that would be far below zero is kept out of the others' intervals: no positive value of it explains them.
  const std::vector<Term> plausible = without_negative(model, linear, solution.powers);
  if (plausible.size() < model.size()) {
    linear = linearise(plausible, fit.terms, fit.model_error);
    for (const Term term : plausible) *estimates[term] = interval(term, linear, solution.powers, fit);
  }
  if (markov && solution.powers[kMarkov] > 0.0) fit.markov_time = time_interval(linear, time);
  if (markov && !fit.markov_flat.observable) fit.markov_time.observable = false;
  return fit;
}

double AllanFitter::criterion(const AllanFit& fit, double parameters, double model_error) const {
  const Eigen::VectorXd pivots = full_covariance(fit.terms, model_error).ldlt().vectorD();
  return pivots.array().log().sum() + chi_square(fit.terms, model_error) + 2.0 * parameters;
}

}  // namespace allan_lio
