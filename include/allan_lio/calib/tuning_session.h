// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/calib/linear_tuning.h"
#include "allan_lio/calib/noise_tuning.h"
#include "allan_lio/calib/traced_runs.h"
#include "allan_lio/calib/trial_pool.h"
#include "allan_lio/io/tuning_report.h"

namespace allan_lio {

/// What a session does and where its files go.
struct SessionSettings {
  NoiseProblem problem;  ///< its bags come first in the TrialProblem
  std::vector<std::uint32_t> held_out;
  TuningPlan plan;
  /// Of a likelihood: a first search takes the errors for independent; what they are worth at its best (HorizonScore,
  /// of scan_nll InnovationWhiteness, the average over the bags) is problem.nll_scale of the search that counts, which
  /// goes on from there; of linear runs it holds from the second round on. Else it holds.
  bool estimate_nll_scale = true;
  TuningReport report;    ///< without the comparisons; `before` is the configuration's noise
  std::string directory;  ///< of the files
  int jobs = 1;           ///< for the runs before and after
  LinearEngine linear;    ///< needed if is_linear()
};

/// Whether the search judges most settings on linear runs.
bool is_linear(const SessionSettings& settings);

/// Whether in none of the first `tuned_on` bags the run with the best setting is of use; false if there are no bags.
bool every_run_diverges(const std::vector<BagComparison>& comparisons, std::size_t tuned_on);

/// A tuning from its trials to its files: before.tum and after.tum of every bag with reference.tum, tuning.yaml,
/// best.yaml, trials.csv. The same settings, the same files, whatever was in the store already.
class TuningSession {
 public:
  /// `problem`, `store` (may be null) and `stop` (may be null) must outlive it; `on_finished` as cached() has it.
  TuningSession(SessionSettings settings, const TrialProblem& problem, TrialEngine engine, TrialStore* store,
                const std::atomic<bool>* stop, OnFinished on_finished);

  /// Throws what the engine throws, TrialsStopped where it was stopped; then call write_what_there_is().
  void run(const OnPhase& on_phase);

  /// After run() threw: trials.csv with every trial that ended, and tuning.yaml of the settings whose trials are
  /// complete, if there is one. `why` stands in it for how the search ended. Throws as write_whole.
  void write_what_there_is(const std::string& why);

  // After run().
  const SessionSettings& settings() const { return settings_; }
  const NoiseEvaluator& evaluator() const { return *evaluator_; }
  const TuningOutcome& outcome() const { return outcome_; }
  const ScoredSetting& best() const { return evaluator_->evaluations()[outcome_.best]; }
  const std::vector<TrialRow>& rows() const { return rows_; }  ///< every trial that ended, of the filter itself
  /// The bags held out, with the configuration's noise and with the best; empty if there are none.
  const std::vector<ScoredSetting>& held_out() const { return held_out_; }

 private:
  /// The first search: sets problem.nll_scale and gives the settings that it tried.
  std::vector<NoiseSetting> measure_nll_scale(const OnPhase& on_phase);
  void tune_linear(const OnPhase& on_phase);
  std::optional<NoiseSetting> surviving_start(const OnPhase& on_phase);
  void tune_by_runs(const OnPhase& on_phase);
  void compare(const std::vector<TracedRun>& before, const std::vector<TracedRun>& after);
  ComparedRun kept(const TracedRun& run, const std::string& name) const;
  void write_trials() const;

  SessionSettings settings_;
  const TrialProblem& problem_;
  const std::atomic<bool>* stop_;
  std::vector<TrialRow> rows_;
  RunTrials run_trials_;
  OnFinished on_run_, on_linear_;  ///< a trial of the filter has ended, one on linear runs
  std::unique_ptr<NoiseEvaluator> evaluator_;
  TuningOutcome outcome_;
  std::vector<ScoredSetting> held_out_;
};

}  // namespace allan_lio
