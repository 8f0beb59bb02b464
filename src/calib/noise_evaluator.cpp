// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_evaluator.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace allan_lio {
namespace {

constexpr double kBrokenNll = 1e12;  ///< of a run whose nll is not finite, which the engine should not give

double ate_of(const NoiseProblem& problem, const TrialResult& result) {
  const bool usable = !result.diverged && std::isfinite(result.ate);
  return usable ? std::min(result.ate, problem.diverged_ate) : problem.diverged_ate;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  if (values.size() < 2) return 0.0;
  const double mean = mean_of(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

/// The data's part of the objective from one run of every bag.
double objective_of_run(const NoiseProblem& problem, const std::vector<TrialResult>& trials, std::size_t run) {
  double sum = 0.0;
  for (std::size_t i = run; i < trials.size(); i += problem.runs) {
    if (!is_likelihood(problem.objective)) {
      sum += ate_of(problem, trials[i]) / static_cast<double>(problem.bags.size());
      continue;
    }
    const double nll = nll_of(problem.objective, trials[i]);
    sum += problem.nll_scale * (std::isfinite(nll) ? nll : kBrokenNll);
  }
  return sum;
}

ScoredSetting make_score(const NoiseProblem& problem, const NoiseSetting& setting, std::vector<TrialResult> trials) {
  ScoredSetting scored;
  scored.setting = setting;
  scored.trials = std::move(trials);
  std::vector<double> runs(problem.runs);
  for (std::size_t run = 0; run < runs.size(); ++run) runs[run] = objective_of_run(problem, scored.trials, run);
  scored.prior = prior_cost(problem, setting);
  scored.objective = mean_of(runs) + scored.prior;
  scored.run_deviation = deviation_of(runs);
  scored.diverged = static_cast<std::uint32_t>(std::count_if(
      scored.trials.begin(), scored.trials.end(), [](const TrialResult& result) { return result.diverged; }));
  return scored;
}

void append_trials(const NoiseProblem& problem, const NoiseSetting& setting, std::vector<NoiseTrial>& trials) {
  for (const std::uint32_t bag : problem.bags)
    for (std::uint32_t run = 0; run < problem.runs; ++run) trials.push_back({bag, setting, run});
}

std::vector<TrialResult> run_batch(const RunTrials& run_trials, const std::vector<NoiseTrial>& trials) {
  std::vector<TrialResult> results = run_trials(trials);
  if (results.size() != trials.size())
    throw std::runtime_error("tuning: the engine gave " + std::to_string(results.size()) + " results for " +
                             std::to_string(trials.size()) + " trials");
  return results;
}

void require_truth(const NoiseProblem& problem, const std::vector<TrialResult>& results) {
  if (problem.objective != TuningObjective::kAte || results.empty()) return;
  const auto without = [](const TrialResult& result) { return !result.diverged && std::isnan(result.ate); };
  if (std::all_of(results.begin(), results.end(), without))
    throw std::runtime_error("tuning: the objective is ate, and no run could be compared with a reference trajectory");
}

AteRange range_of(const NoiseProblem& problem, const std::vector<TrialResult>& trials, std::size_t first,
                  std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = first; i < first + count; ++i) values.push_back(ate_of(problem, trials[i]));
  const auto ends = std::minmax_element(values.begin(), values.end());
  return {*ends.second, *ends.first, mean_of(values)};
}

}  // namespace

AteRange ate_range(const NoiseProblem& problem, const ScoredSetting& scored) {
  return range_of(problem, scored.trials, 0, scored.trials.size());
}

AteRange ate_range(const NoiseProblem& problem, const ScoredSetting& scored, std::size_t index) {
  return range_of(problem, scored.trials, index * problem.runs, problem.runs);
}

NoiseEvaluator::NoiseEvaluator(NoiseProblem problem, RunTrials run_trials)
    : problem_(std::move(problem)), run_trials_(std::move(run_trials)) {
  check_problem(problem_);
}

std::size_t NoiseEvaluator::find(const NoiseSetting& setting) const {
  std::size_t i = 0;
  while (i < evaluations_.size() && !same_setting(evaluations_[i].setting, setting)) ++i;
  return i;
}

std::vector<std::size_t> NoiseEvaluator::evaluate(const std::vector<NoiseSetting>& settings) {
  std::vector<NoiseSetting> fresh;
  std::vector<NoiseTrial> trials;
  for (const NoiseSetting& setting : settings) {
    const auto same = [&](const NoiseSetting& other) { return same_setting(setting, other); };
    if (find(setting) < evaluations_.size() || std::any_of(fresh.begin(), fresh.end(), same)) continue;
    fresh.push_back(setting);
    append_trials(problem_, setting, trials);
  }
  if (!fresh.empty()) {
    const std::vector<TrialResult> results = run_batch(run_trials_, trials);
    require_truth(problem_, results);
    const auto share = static_cast<std::ptrdiff_t>(results.size() / fresh.size());
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      const auto first = results.begin() + static_cast<std::ptrdiff_t>(i) * share;
      evaluations_.push_back(make_score(problem_, fresh[i], {first, first + share}));
    }
  }
  std::vector<std::size_t> places;
  for (const NoiseSetting& setting : settings) places.push_back(find(setting));
  return places;
}

std::size_t NoiseEvaluator::best() const {
  if (evaluations_.empty()) throw std::logic_error("tuning: nothing was evaluated");
  const auto lower = [](const ScoredSetting& a, const ScoredSetting& b) { return a.objective < b.objective; };
  return static_cast<std::size_t>(std::min_element(evaluations_.begin(), evaluations_.end(), lower) -
                                  evaluations_.begin());
}

ScoredSetting score(const NoiseProblem& problem, const RunTrials& run_trials, const NoiseSetting& setting,
                    const std::vector<std::uint32_t>& bags) {
  NoiseProblem held_out = problem;
  held_out.bags = bags;
  NoiseEvaluator evaluator(held_out, run_trials);
  return evaluator.evaluations()[evaluator.evaluate(setting)];
}

}  // namespace allan_lio
