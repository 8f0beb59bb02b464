// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "allan_lio/calib/noise_search.h"
#include "search_parts.h"

namespace allan_lio {
namespace {

constexpr double kScan[] = {kLowestUsual, 0.3, 1.0, 3.0, 10.0, kHighestUsual};  ///< all tuned k alike
constexpr double kNarrower = 0.4;    ///< a new start's first step by the last one's
constexpr double kNarrowest = 0.15;  ///< first step, of ln k

/// The budget is spent: the search ends where it is.
struct Spent {};

bool any_survived(const NoiseEvaluator& evaluator) {
  const auto survived = [](const ScoredSetting& scored) { return scored.diverged < scored.trials.size(); };
  return std::any_of(evaluator.evaluations().begin(), evaluator.evaluations().end(), survived);
}

/// As many of the settings as the budget allows, in one batch.
void scan(NoiseEvaluator& evaluator, std::vector<NoiseSetting> settings, std::size_t limit) {
  const std::size_t done = evaluator.evaluations().size();
  settings.resize(std::min(settings.size(), limit > done ? limit - done : 0));
  evaluator.evaluate(settings);
}

void scan_diagonal(NoiseEvaluator& evaluator, std::size_t limit) {
  const NoiseProblem& problem = evaluator.problem();
  std::vector<NoiseSetting> settings = {problem.start};
  for (const double k : kScan)
    settings.push_back(
        setting_at(problem, Eigen::VectorXd::Constant(static_cast<int>(problem.tuned.size()), std::log(k))));
  scan(evaluator, settings, limit);
}

/// Points spread over the usual range and over the box by turns, until a run survives somewhere or half of the
/// budget is gone.
void scan_widely(NoiseEvaluator& evaluator, std::size_t limit) {
  const NoiseProblem& problem = evaluator.problem();
  constexpr int kBatch = 8;
  const Eigen::VectorXd low = lower_logs(problem), high = upper_logs(problem);
  const Eigen::VectorXd near_low = lower_usual_logs(problem), near_high = upper_usual_logs(problem);
  std::mt19937_64 bits(1);
  const std::size_t enough = (evaluator.evaluations().size() + limit) / 2;
  for (bool near = true; !any_survived(evaluator) && evaluator.evaluations().size() < enough; near = !near) {
    const Eigen::MatrixXd points = latin_hypercube(near ? near_low : low, near ? near_high : high, kBatch, bits);
    std::vector<NoiseSetting> settings;
    for (int i = 0; i < kBatch; ++i) settings.push_back(setting_at(problem, points.col(i)));
    scan(evaluator, settings, limit);
  }
}

MildObjective mild_of(const NoiseEvaluator& evaluator) {
  std::vector<double> values;
  for (const ScoredSetting& scored : evaluator.evaluations()) values.push_back(scored.objective);
  return MildObjective::of(values);
}

/// BOBYQA from the best setting so far, again and again until neither the point nor the objective moves.
void descend(NoiseEvaluator& evaluator, const LikelihoodSearchOptions& options, std::size_t limit) {
  constexpr int kLeastRounds = 2, kMostRounds = 20;
  const NoiseProblem& problem = evaluator.problem();
  const MildObjective mild = mild_of(evaluator);
  const auto value = [&](const Eigen::VectorXd& x) {
    const NoiseSetting setting = setting_at(problem, x);
    if (evaluator.evaluations().size() >= limit) throw Spent();
    return mild(evaluator.evaluations()[evaluator.evaluate(setting)].objective);
  };
  BoxSearch box{lower_logs(problem), upper_logs(problem), options.first_step, options.tolerance};
  for (int round = 0; round < kMostRounds; ++round) {
    const Eigen::VectorXd before = log_point(problem, evaluator.evaluations()[evaluator.best()].setting);
    minimise(box, before, value);
    const Eigen::VectorXd after = log_point(problem, evaluator.evaluations()[evaluator.best()].setting);
    if (round + 1 >= kLeastRounds && (after - before).lpNorm<Eigen::Infinity>() < 2.0 * options.tolerance) return;
    box.first_step = std::max(kNarrowest, kNarrower * box.first_step);
  }
}

}  // namespace

SearchResult search_likelihood(NoiseEvaluator& evaluator, const LikelihoodSearchOptions& options) {
  const std::size_t limit = evaluator.evaluations().size() + std::max<std::size_t>(1, options.most_settings);
  SearchResult result;
  scan_diagonal(evaluator, limit);
  scan_widely(evaluator, limit);
  if (!any_survived(evaluator)) {
    result.end = SearchEnd::kAllDiverged;
  } else {
    try {
      descend(evaluator, options, limit);
    } catch (const Spent&) {
      result.end = SearchEnd::kBudgetSpent;
    }
  }
  result.best = evaluator.best();
  return result;
}

}  // namespace allan_lio
