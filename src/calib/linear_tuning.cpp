// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_tuning.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

namespace allan_lio {
namespace {

bool tunes(const NoiseProblem& problem, NoiseParameter parameter) {
  return std::find(problem.tuned.begin(), problem.tuned.end(), parameter) != problem.tuned.end();
}

/// Those of the problem none of whose runs diverged.
std::vector<std::uint32_t> whole_bags(const NoiseProblem& problem, const std::vector<LinearisedTrial>& runs) {
  std::set<std::uint32_t> broken;
  for (const LinearisedTrial& run : runs)
    if (run.run.scans.empty()) broken.insert(run.trial.bag);
  std::vector<std::uint32_t> bags;
  std::copy_if(problem.bags.begin(), problem.bags.end(), std::back_inserter(bags),
               [&broken](std::uint32_t bag) { return broken.count(bag) == 0; });
  return bags;
}

RunTrials reported(const TrialEngine& engine, const OnFinished& on_finished) {
  return [engine, on_finished](const std::vector<NoiseTrial>& trials) {
    std::size_t done = 0;
    return engine(trials, [&](std::size_t i, const TrialResult& result) {
      if (on_finished) on_finished({trials[i], result, false, ++done, trials.size()});
    });
  };
}

}  // namespace

std::size_t believed_round(const std::vector<LinearRound>& rounds) {
  const auto likeliest = std::min_element(rounds.begin(), rounds.end(), [](const LinearRound& a, const LinearRound& b) {
    return a.objective < b.objective;
  });
  const bool much_likelier = likeliest->objective < rounds.back().objective - kWorseRuns;
  return much_likelier ? static_cast<std::size_t>(likeliest - rounds.begin()) : rounds.size() - 1;
}

bool went_astray(const std::vector<LinearRound>& rounds) {
  if (rounds.size() < 3) return false;
  const auto last = rounds.end() - 1;
  const bool both_found = same_setting((last - 1)->at, (last - 2)->found) && same_setting(last->at, (last - 1)->found);
  return both_found && last->objective > (last - 1)->objective + kWorseRuns;
}

LinearTuning::LinearTuning(NoiseProblem problem, LinearTuningOptions options)
    : problem_(std::move(problem)), options_(std::move(options)) {
  check_problem(problem_);
  if (!is_likelihood(problem_.objective))
    throw std::invalid_argument("a linear run knows no ground truth: its objective is nll or scan_nll");
  if (options_.estimate_nll_scale) problem_.nll_scale = 1.0;
}

std::vector<LinearisedTrial> LinearTuning::run_filter(const NoiseProblem& problem, const NoiseSetting& at,
                                                      const OnPhase& on_phase) {
  if (on_phase) on_phase("runs of the filter, round " + std::to_string(rounds_.size() + 1), 1);
  std::vector<LinearisedTrial> runs = linearise(options_.engine, problem, at, options_.on_run);
  LinearRound round;
  round.at = round.found = at;
  round.runs = static_cast<std::uint32_t>(runs.size());
  for (const LinearisedTrial& run : runs) round.diverged += run.run.scans.empty() ? 1 : 0;
  if (problem.bags.size() == problem_.bags.size()) round.objective = objective_of(runs);
  rounds_.push_back(round);
  return runs;
}

double LinearTuning::objective_of(const std::vector<LinearisedTrial>& runs) const {
  double sum = prior_cost(problem_, runs[0].trial.setting);
  for (const LinearisedTrial& run : runs) sum += nll_of(problem_.objective, run.result) / problem_.runs;
  return sum;
}

bool LinearTuning::is_lost(const LinearisedTrial& run) const {
  const TrialResult& r = run.result;
  const bool horizons = problem_.objective == TuningObjective::kNll;
  const double nis = horizons ? r.horizon_nis : r.nis;
  const double dof = horizons ? r.horizon_dof : static_cast<double>(r.nis_dof);
  return run.run.scans.empty() || nis > kLost * dof;
}

/// A run that is not lost, or else the likelier one.
bool LinearTuning::is_better(const LinearisedTrial& run, const LinearisedTrial& than) const {
  if (is_lost(run) != is_lost(than)) return is_lost(than);
  return nll_of(problem_.objective, run.result) < nll_of(problem_.objective, than.result);
}

NoiseSetting LinearTuning::better_beginning(std::vector<LinearisedTrial>& runs, const OnPhase& on_phase) {
  NoiseSetting alike = runs[0].trial.setting;
  const auto lost = [this](const LinearisedTrial& run) { return is_lost(run); };
  const auto first = std::find_if(runs.begin(), runs.end(), lost);
  if (first == runs.end()) return alike;
  for (const double k : {3.0, 10.0, 30.0}) {
    NoiseProblem of_lost = problem_;
    const auto none_lost = [&](std::uint32_t bag) {
      return std::none_of(runs.begin(), runs.end(),
                          [&](const LinearisedTrial& run) { return run.trial.bag == bag && is_lost(run); });
    };
    of_lost.bags.erase(std::remove_if(of_lost.bags.begin(), of_lost.bags.end(), none_lost), of_lost.bags.end());
    if (of_lost.bags.empty()) break;
    for (const NoiseParameter parameter : problem_.tuned)
      if (parameter != NoiseParameter::kKr)
        multiplier(alike, parameter) = std::min(std::max(k, problem_.lowest_k), problem_.highest_k);
    for (LinearisedTrial& other : run_filter(of_lost, alike, on_phase)) {
      const auto same = std::find_if(runs.begin(), runs.end(), [&other](const LinearisedTrial& run) {
        return run.trial.bag == other.trial.bag && run.trial.run == other.trial.run;
      });
      if (is_lost(*same) && is_better(other, *same)) *same = std::move(other);
    }
  }
  const NoiseSetting at = first->trial.setting;
  const auto chosen = std::find_if(rounds_.begin(), rounds_.end(),
                                   [&at](const LinearRound& round) { return same_setting(round.at, at); });
  std::rotate(chosen, chosen + 1, rounds_.end());  // it is what the search goes on from
  return at;
}

bool LinearTuning::run(const OnPhase& on_phase) {
  NoiseSetting at = options_.first.value_or(problem_.start);
  std::vector<LinearisedTrial> runs = run_filter(problem_, at, on_phase);
  at = better_beginning(runs, on_phase);
  if (whole_bags(problem_, runs).empty()) return false;
  for (int round = 0;; ++round) {
    const std::vector<std::uint32_t> bags = whole_bags(problem_, runs);
    if (bags.empty()) break;
    settle(at, std::make_shared<const std::vector<LinearisedTrial>>(std::move(runs)), bags, round, on_phase);
    if (at_rest_ || round + 1 == kMostRounds) break;
    if (round == 0 && options_.estimate_nll_scale) problem_.nll_scale = mean_share();
    at = rounds_.back().found;
    runs = run_filter(problem_, at, on_phase);
    if (went_astray(rounds_)) break;
  }
  believe_the_runs();
  return true;
}

void LinearTuning::believe_the_runs() {
  const std::size_t believed = believed_round(rounds_);
  was_overruled_ = believed + 1 < rounds_.size();
  if (!was_overruled_) return;
  outcome_.best = evaluator_->evaluate(rounds_[believed].at);
  outcome_.profiles.clear();
}

/// One round on linear runs.
void LinearTuning::settle(const NoiseSetting& at, Runs runs, const std::vector<std::uint32_t>& bags, int round,
                          const OnPhase& on_phase) {
  if (on_phase) on_phase("the LiDAR's errors", 1);
  LidarErrorStart start;
  start.setting = at;
  start.warm = round > 0;
  if (start.warm) start.errors = rounds_[rounds_.size() - 2].errors;
  LidarErrorFit fit = fit_lidar_errors(*runs, problem_, start, options_.pool);
  NoiseSetting likely = at;
  if (tunes(problem_, NoiseParameter::kKr)) likely.k_r *= std::exchange(fit.errors.white, 1.0);
  NoiseProblem problem = problem_;
  problem.bags = bags;
  likely = setting_at(problem, log_point(problem, likely));  // in the box
  auto evaluator = std::make_unique<NoiseEvaluator>(
      problem, reported(make_linear_trials(runs, fit.errors, options_.pool), options_.on_linear));
  const std::size_t before = evaluator->evaluate(likely);
  TuningPlan plan = options_.plan;
  plan.with_profiles = false;
  TuningOutcome outcome = tune(*evaluator, plan, on_phase);
  const auto objective = [&](std::size_t place) { return evaluator->evaluations()[place].objective; };
  at_rest_ = objective(before) - objective(outcome.best) < kAsGood;
  if (round == 0 && options_.estimate_nll_scale) at_rest_ = false;  // the prior's weight is still to be found
  const auto made_at = [&at](const LinearisedTrial& run) { return same_setting(run.trial.setting, at); };
  if (!std::all_of(runs->begin(), runs->end(), made_at)) at_rest_ = false;  // no run has shown what it is like
  if (at_rest_ || round + 1 == kMostRounds) {
    if (options_.plan.with_profiles) outcome = tune(*evaluator, options_.plan, on_phase);
    if (on_phase) on_phase("the LiDAR's errors", 1);
    start.setting = evaluator->evaluations()[outcome.best].setting;
    start.errors = fit.errors;
    start.warm = start.with_deviations = true;
    scan_fit_ = fit_lidar_errors(*runs, problem_, start, options_.pool);
  }
  rounds_.back().found = evaluator->evaluations()[outcome.best].setting;
  rounds_.back().errors = fit.errors;
  evaluator_ = std::move(evaluator);
  outcome_ = std::move(outcome);
}

double LinearTuning::mean_share() const {
  if (problem_.objective != TuningObjective::kNll) return 1.0;  // with the LiDAR's errors fitted innovations are white
  const std::vector<TrialResult>& trials = evaluator_->evaluations()[outcome_.best].trials;
  double sum = 0.0;
  for (const TrialResult& result : trials) sum += result.horizon_share;
  return sum / static_cast<double>(trials.size());
}

}  // namespace allan_lio
