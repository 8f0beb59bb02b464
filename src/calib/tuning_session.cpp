// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "allan_lio/io/whole_file.h"
#include "salvage.h"

namespace allan_lio {
namespace {

constexpr double kTwoSided = 1.959963984540054;  ///< 97.5 % of the normal distribution

/// The average over the bags tuned on of what their errors are worth against independent ones.
double mean_share(const std::vector<TracedRun>& runs, const NoiseProblem& problem) {
  double sum = 0.0;
  for (const std::uint32_t bag : problem.bags)
    sum +=
        problem.objective == TuningObjective::kScanNll ? runs[bag].independent_share : runs[bag].result.horizon_share;
  return sum / static_cast<double>(problem.bags.size());
}

/// As write_tum, but in one piece.
void write_poses(const std::string& path, const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory) text += format_tum_line(pose) + "\n";
  write_whole(path, text);
}

}  // namespace

bool is_linear(const SessionSettings& settings) {
  return settings.plan.search == TuningSearch::kLikelihood && !settings.plan.rerun &&
         is_likelihood(settings.problem.objective);
}

bool every_run_diverges(const std::vector<BagComparison>& comparisons, std::size_t tuned_on) {
  const auto end = comparisons.begin() + static_cast<std::ptrdiff_t>(std::min(tuned_on, comparisons.size()));
  return end != comparisons.begin() && std::all_of(comparisons.begin(), end, [](const BagComparison& comparison) {
           return comparison.after.result.diverged;
         });
}

TuningSession::TuningSession(SessionSettings settings, const TrialProblem& problem, TrialEngine engine,
                             TrialStore* store, const std::atomic<bool>* stop, OnFinished on_finished)
    : settings_(std::move(settings)), problem_(problem), stop_(stop) {
  check_problem(settings_.problem);
  on_linear_ = std::move(on_finished);
  on_run_ = [this](const FinishedTrial& finished) {
    rows_.emplace_back(finished.trial, finished.result);
    if (on_linear_) on_linear_(finished);
  };
  run_trials_ = cached(std::move(engine), problem, store, on_run_);
}

void TuningSession::tune_linear(const OnPhase& on_phase) {
  LinearTuningOptions options;
  options.plan = settings_.plan;
  options.estimate_nll_scale = settings_.estimate_nll_scale;
  options.engine = settings_.linear;
  options.pool = {settings_.jobs, stop_};
  options.on_run = on_run_;
  options.on_linear = on_linear_;
  auto tuning = std::make_unique<LinearTuning>(settings_.problem, options);
  std::vector<LinearRound> rounds;
  if (!tuning->run(on_phase)) {
    rounds = tuning->rounds();
    options.first = surviving_start(on_phase);
    if (!options.first) return tune_by_runs(on_phase);  // which says that all diverged
    tuning = std::make_unique<LinearTuning>(settings_.problem, options);
    if (!tuning->run(on_phase)) return tune_by_runs(on_phase);
  }
  rounds.insert(rounds.end(), tuning->rounds().begin(), tuning->rounds().end());
  settings_.report.rounds = std::move(rounds);
  outcome_ = tuning->outcome();
  evaluator_ = tuning->take_evaluator();
  if (tuning->was_overruled())
    outcome_.end = "the runs themselves were likeliest with this setting, and not with the linear filter's best";
  else if (!tuning->at_rest())
    outcome_.end = "did not come to rest in " + std::to_string(tuning->rounds().size()) + " rounds of runs";
  for (NoiseProfile& profile : outcome_.profiles) {
    if (profile.parameter == NoiseParameter::kKr || !tuning->scan_fit()) continue;
    const double deviation = tuning->scan_fit()->deviations[static_cast<std::size_t>(profile.parameter)];
    const double k = multiplier(tuning->scan_fit()->setting, profile.parameter);
    profile.scan_low = k * std::exp(-kTwoSided * deviation);
    profile.scan_high = k * std::exp(kTwoSided * deviation);
  }
}

/// With which not every run diverges: of all k alike, the best by runs of the filter.
std::optional<NoiseSetting> TuningSession::surviving_start(const OnPhase& on_phase) {
  constexpr std::size_t kSettings = 14;
  if (on_phase) on_phase("a start that does not diverge", kSettings);
  NoiseEvaluator evaluator(settings_.problem, run_trials_);
  LikelihoodSearchOptions options;
  options.most_settings = kSettings;
  const SearchResult found = search_likelihood(evaluator, options);
  if (found.end == SearchEnd::kAllDiverged) return std::nullopt;
  return evaluator.evaluations()[found.best].setting;
}

void TuningSession::tune_by_runs(const OnPhase& on_phase) {
  TuningPlan plan = settings_.plan;
  std::vector<NoiseSetting> tried;
  if (settings_.estimate_nll_scale && is_likelihood(settings_.problem.objective)) {
    tried = measure_nll_scale(on_phase);
    if (plan.search == TuningSearch::kBayes) plan.budget = 1;  // it has spent its own; the scale moves little
  }
  evaluator_ = std::make_unique<NoiseEvaluator>(settings_.problem, run_trials_);
  evaluator_->evaluate(tried);
  outcome_ = tune(*evaluator_, plan, on_phase);
}

std::vector<NoiseSetting> TuningSession::measure_nll_scale(const OnPhase& on_phase) {
  NoiseProblem& problem = settings_.problem;
  problem.nll_scale = 1.0;
  NoiseEvaluator evaluator(problem, run_trials_);
  TuningPlan plan = settings_.plan;
  plan.with_profiles = false;
  const TuningOutcome outcome = tune(evaluator, plan, on_phase);
  const NoiseSetting& best = evaluator.evaluations()[outcome.best].setting;
  problem.nll_scale = mean_share(run_traced(problem_, best, settings_.jobs, stop_), problem);
  std::vector<NoiseSetting> tried;
  for (const ScoredSetting& scored : evaluator.evaluations()) tried.push_back(scored.setting);
  return tried;
}

void TuningSession::run(const OnPhase& on_phase) {
  const NoiseSetting before = settings_.report.before;
  const std::vector<TracedRun> runs_before = run_traced(problem_, before, settings_.jobs, stop_);
  const NoiseProblem& problem = settings_.problem;
  if (is_linear(settings_))
    tune_linear(on_phase);
  else
    tune_by_runs(on_phase);
  if (!settings_.held_out.empty()) {
    if (on_phase) on_phase("bags held out", 2);
    NoiseProblem plain = problem;
    plain.objective = TuningObjective::kNll;  // also where there is no truth
    for (const NoiseSetting& setting : {before, best().setting})
      held_out_.push_back(score(plain, run_trials_, setting, settings_.held_out));
  }
  compare(runs_before, run_traced(problem_, best().setting, settings_.jobs, stop_));
  write_trials();
  write_whole(
      settings_.directory + "/best.yaml",
      setting_yaml(
          best().setting,
          {"Found by tune_noise, " + std::string(name_of(settings_.plan.search)) + " search: " + outcome_.end + ".",
           "Name it in your configuration's include list; a k that the configuration sets itself wins."}));
  write_whole(settings_.directory + "/tuning.yaml", tuning_yaml(settings_.report, *evaluator_, outcome_));
}

void TuningSession::compare(const std::vector<TracedRun>& before, const std::vector<TracedRun>& after) {
  settings_.report.comparisons.clear();
  for (std::uint32_t bag = 0; bag < before.size(); ++bag) {
    const std::string number = std::to_string(bag) + ".tum";
    BagComparison comparison;
    comparison.bag = bag;
    comparison.before = kept(before[bag], "before_" + number);
    comparison.after = kept(after[bag], "after_" + number);
    const Trajectory& reference = problem_.bags()[bag].record.reference();
    if (!reference.empty()) {
      comparison.reference = "reference_" + number;
      write_poses(settings_.directory + "/" + comparison.reference, reference);
    }
    settings_.report.comparisons.push_back(comparison);
  }
}

ComparedRun TuningSession::kept(const TracedRun& run, const std::string& name) const {
  if (run.trajectory.empty()) return {"", run.result};
  write_poses(settings_.directory + "/" + name, run.trajectory);
  return {name, run.result};
}

void TuningSession::write_trials() const { write_whole(settings_.directory + "/trials.csv", trials_csv(rows_)); }

void TuningSession::write_what_there_is(const std::string& why) {
  if (rows_.empty()) return;
  write_trials();
  const Salvage salvage(rows_);
  const std::vector<NoiseSetting> settings = salvage.complete_settings(settings_.problem);
  if (settings.empty()) return;
  NoiseEvaluator evaluator(settings_.problem, [&salvage](const std::vector<NoiseTrial>& trials) {
    std::vector<TrialResult> results;
    for (const NoiseTrial& trial : trials) results.push_back(*salvage.find(trial));
    return results;
  });
  evaluator.evaluate(settings);
  TuningOutcome outcome;
  outcome.best = evaluator.best();
  outcome.end = why;
  write_whole(settings_.directory + "/tuning.yaml", tuning_yaml(settings_.report, evaluator, outcome));
}

}  // namespace allan_lio
