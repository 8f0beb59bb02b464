// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "allan_lio/calib/gaussian_process.h"
#include "allan_lio/calib/noise_search.h"
#include "search_parts.h"

namespace allan_lio {
namespace {

constexpr double kNoImprovement = 1e-6;  ///< expected, by the deviation of the values: nothing is left to find

/// The problem's start, k = 1 and points spread over the usual range, in one batch.
void spread_start(NoiseEvaluator& evaluator, std::size_t limit, std::mt19937_64& bits) {
  const NoiseProblem& problem = evaluator.problem();
  const auto tuned = static_cast<int>(problem.tuned.size());
  const int count = 3 * tuned + 2;
  std::vector<NoiseSetting> settings = {problem.start, setting_at(problem, Eigen::VectorXd::Zero(tuned))};
  const Eigen::MatrixXd points = latin_hypercube(lower_usual_logs(problem), upper_usual_logs(problem), count, bits);
  for (int i = 0; i < count; ++i) settings.push_back(setting_at(problem, points.col(i)));
  const std::size_t room = limit - std::min(limit, evaluator.evaluations().size());
  settings.resize(std::min(settings.size(), room));
  evaluator.evaluate(settings);
}

/// The evaluations as the process sees them.
struct Surrogate {
  Eigen::MatrixXd points;  ///< a column each
  GaussianProcess process;
  double lowest = std::numeric_limits<double>::infinity();  ///< mean at an evaluated point
  std::size_t best = 0;                                     ///< that point
  double deviation = 0.0;                                   ///< of the values

  /// The filter being deterministic, the same setting again tells nothing new.
  bool is_known(const Eigen::VectorXd& x) const {
    constexpr double kSame = 0.02;  // of ln k
    return (points.colwise() - x).colwise().lpNorm<Eigen::Infinity>().minCoeff() < kSame;
  }
};

Surrogate make_surrogate(const NoiseEvaluator& evaluator) {
  const NoiseProblem& problem = evaluator.problem();
  const std::vector<ScoredSetting>& done = evaluator.evaluations();
  std::vector<double> values;
  for (const ScoredSetting& scored : done) values.push_back(scored.objective);
  const MildObjective mild = MildObjective::of(values);
  Eigen::MatrixXd x(problem.tuned.size(), done.size());
  Eigen::VectorXd y(done.size());
  for (std::size_t i = 0; i < done.size(); ++i) {
    x.col(static_cast<Eigen::Index>(i)) = log_point(problem, done[i].setting);
    y[static_cast<Eigen::Index>(i)] = mild(values[i]);
  }
  Surrogate surrogate{x, GaussianProcess::fit(x, y, upper_logs(problem) - lower_logs(problem))};
  surrogate.deviation = std::sqrt((y.array() - y.mean()).square().mean());
  for (std::size_t i = 0; i < done.size(); ++i) {
    const double mean = surrogate.process.predict(x.col(static_cast<Eigen::Index>(i))).mean;
    if (mean >= surrogate.lowest) continue;
    surrogate.lowest = mean;
    surrogate.best = i;
  }
  return surrogate;
}

/// Where a proposal is looked for: by turns all over the box, which the expected improvement alone would spend mostly
/// at its corners, and near the best setting.
BoxSearch region_of(const NoiseProblem& problem, const Eigen::VectorXd& best, bool near) {
  constexpr double kNear = 1.0;  // [ln k]
  BoxSearch box{lower_logs(problem), upper_logs(problem), 0.2, 1e-3, 100};
  if (!near) return box;
  box.low = box.low.cwiseMax((best.array() - kNear).matrix());
  box.high = box.high.cwiseMin((best.array() + kNear).matrix());
  return box;
}

/// Where the expected improvement is largest: the best candidate, improved by BOBYQA.
struct Proposal {
  Eigen::VectorXd point;
  double gain = 0.0;
};

Proposal propose(const BoxSearch& region, const Surrogate& surrogate, std::mt19937_64& bits) {
  constexpr int kPerCoefficient = 300;
  const auto loss = [&](const Eigen::VectorXd& x) {
    if (surrogate.is_known(x)) return 0.0;
    const GaussianProcess::Prediction there = surrogate.process.predict(x);
    return -expected_improvement(there.mean, std::sqrt(there.variance), surrogate.lowest);
  };
  const auto coefficients = static_cast<int>(region.low.size());
  const Eigen::MatrixXd points = latin_hypercube(region.low, region.high, kPerCoefficient * coefficients, bits);
  Eigen::VectorXd values(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) values[i] = loss(points.col(i));
  Eigen::Index lowest = 0;
  values.minCoeff(&lowest);
  const Eigen::VectorXd point = minimise(region, points.col(lowest), loss);
  return {point, -loss(point)};
}

}  // namespace

SearchResult search_bayes(NoiseEvaluator& evaluator, const BayesSearchOptions& options) {
  const NoiseProblem& problem = evaluator.problem();
  const std::size_t limit = evaluator.evaluations().size() + std::max<std::size_t>(1, options.most_settings);
  std::mt19937_64 bits(options.seed);
  spread_start(evaluator, limit, bits);
  SearchResult result;
  for (bool near = false;; near = !near) {
    const Surrogate surrogate = make_surrogate(evaluator);
    result.best = surrogate.best;
    result.end = SearchEnd::kBudgetSpent;
    if (evaluator.evaluations().size() >= limit) return result;
    const BoxSearch region = region_of(problem, surrogate.points.col(static_cast<Eigen::Index>(surrogate.best)), near);
    const Proposal proposal = propose(region, surrogate, bits);
    result.end = SearchEnd::kConverged;
    if (!near && proposal.gain <= kNoImprovement * surrogate.deviation) return result;
    evaluator.evaluate(setting_at(problem, proposal.point));
  }
}

}  // namespace allan_lio
