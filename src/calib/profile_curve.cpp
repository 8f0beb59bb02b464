// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "profile_curve.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

namespace allan_lio {
namespace {

double data_part(const ScoredSetting& scored) { return scored.objective - scored.prior; }

/// Where the line through two points (t, root of the rise) is at `root`.
double between(const std::pair<double, double>& inside, const std::pair<double, double>& outside, double level) {
  const double from = std::sqrt(inside.second), to = std::sqrt(outside.second);
  return inside.first + (outside.first - inside.first) * (std::sqrt(level) - from) / (to - from);
}

template <typename Iterator>
double outermost_crossing(Iterator outer, Iterator end, double level, double open) {
  if (outer->second < level) return open;
  for (Iterator inner = std::next(outer); inner != end; ++outer, ++inner)
    if (inner->second < level) return between(*inner, *outer, level);
  return open;
}

}  // namespace

bool ProfileCurve::has(double t) const {
  constexpr double kNear = 0.005;  // of ln k
  const auto next = places_.lower_bound(t - kNear);
  return next != places_.end() && next->first <= t + kNear;
}

std::map<double, double> ProfileCurve::rises(const NoiseEvaluator& evaluator) const {
  std::map<double, double> values;
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto& [t, place] : places_) {
    values[t] = data_part(evaluator.evaluations()[place]);
    lowest = std::min(lowest, values[t]);
  }
  for (auto& point : values) point.second -= lowest;
  return values;
}

double ProfileCurve::crossing(const NoiseEvaluator& evaluator, int side, double level) const {
  const std::map<double, double> values = rises(evaluator);
  constexpr double kOpen = std::numeric_limits<double>::infinity();
  return side < 0 ? outermost_crossing(values.begin(), values.end(), level, -kOpen)
                  : outermost_crossing(values.rbegin(), values.rend(), level, kOpen);
}

Eigen::MatrixXd curvature_at(NoiseEvaluator& evaluator, std::size_t optimum, const Eigen::VectorXd& widths,
                             double least) {
  const NoiseProblem& problem = evaluator.problem();
  const Eigen::VectorXd center = log_point(problem, evaluator.evaluations()[optimum].setting);
  const Eigen::Index n = widths.size();
  std::vector<NoiseSetting> settings;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i; j < n; ++j) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
      step[i] = widths[i];
      step[j] = widths[j];
      settings.push_back(setting_at(problem, center + step));
      settings.push_back(setting_at(problem, center - step));
    }
  }
  const std::vector<std::size_t> places = evaluator.evaluate(settings);
  Eigen::MatrixXd sums(n, n);  // of the rises at both ends
  const double lowest = evaluator.evaluations()[optimum].objective;
  auto place = places.begin();
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = i; j < n; ++j, place += 2)
      sums(i, j) =
          evaluator.evaluations()[place[0]].objective + evaluator.evaluations()[place[1]].objective - 2 * lowest;
  Eigen::MatrixXd curvature(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    curvature(i, i) = sums(i, i) / (widths[i] * widths[i]);
    for (Eigen::Index j = 0; j < i; ++j)
      curvature(i, j) = curvature(j, i) = 0.5 * (sums(j, i) - sums(i, i) - sums(j, j)) / (widths[i] * widths[j]);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(curvature);
  return solver.eigenvectors() * solver.eigenvalues().cwiseMax(least).asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace allan_lio
