// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "allan_lio/calib/linear_trials.h"
#include "allan_lio/calib/noise_tuning.h"

namespace allan_lio {

/// Runs of the filter at one setting, and what their linear filter made of them.
struct LinearRound {
  NoiseSetting at, found;  ///< the same where the runs only looked for a beginning
  LidarErrors errors;
  /// Of the runs themselves, with the prior and as if all were independent [nats]; infinite where only the bags whose
  /// runs were lost were run.
  double objective = std::numeric_limits<double>::infinity();
  std::uint32_t runs = 0, diverged = 0;  ///< of the filter; bags with a diverged run are left out of the round
};

/// The round whose setting is believed: the last one, unless the runs of an earlier one are likelier by kWorseRuns; of
/// several the likeliest. There must be one.
std::size_t believed_round(const std::vector<LinearRound>& rounds);

/// Whether the last round, like the one before it at a setting that a linear filter found, is less likely than that one
/// by kWorseRuns: the linear filter's bests go to and fro, and more of them tell no more.
bool went_astray(const std::vector<LinearRound>& rounds);

constexpr double kWorseRuns = 10.0;  ///< [nats], twice what planes that are matched or not make of a run

struct LinearTuningOptions {
  TuningPlan plan;                 ///< search by likelihood
  bool estimate_nll_scale = true;  ///< from the first round's best on: HorizonScore's share, the average over the bags
  std::optional<NoiseSetting> first;  ///< where the first runs are made, if not at the problem's start
  LinearEngine engine;                ///< of the runs of the filter; needed
  LinearPool pool;                    ///< of the linear filter
  OnFinished on_run;                  ///< of the filter; may be empty
  OnFinished on_linear;               ///< of the linear filter; may be empty
};

/// The likelihood search without a run for every setting: the bags are run once with the setting at hand and
/// linearised, the best setting by their linear filter is the next one at hand, and so on until the one at hand is as
/// good as the best (within kAsGood). Two or three rounds, up to nine where runs are lost, instead of a hundred
/// settings run; and smooth, so that curvature and profiles are the data's and not those of planes that are matched or
/// not.
///
/// The last word have the runs: if those of an earlier round are likelier by kWorseRuns than the last one's, its
/// setting is the best, and there are no profiles. The search ends where it went_astray().
///
/// A run that is lost is linearised about states that are wrong, and tells nothing of the right noise. So the bags
/// whose first runs diverge or are worse than they claim by kLost are run with all tuned k alike at 3, 10 and 30, until
/// none is lost: each run is linearised by itself, and the first round takes of each bag the run that is best.
class LinearTuning {
 public:
  static constexpr double kAsGood = 0.5;  ///< [nats]
  static constexpr int kMostRounds = 6;
  static constexpr double kLost = 4.0;  ///< NIS per degree of freedom over horizons (scan_nll: from scan to scan)

  /// Throws std::invalid_argument as check_problem does, or if the objective is ATE.
  LinearTuning(NoiseProblem problem, LinearTuningOptions options);

  /// False if of every bag a run diverged with whatever was tried to begin with; then nothing is known. Throws what
  /// engines throw.
  bool run(const OnPhase& on_phase);

  const std::vector<LinearRound>& rounds() const { return rounds_; }
  bool at_rest() const { return at_rest_; }
  bool was_overruled() const { return was_overruled_; }  ///< by the runs of an earlier round

  // After run() that gave true:
  /// Of the last round. Its problem has the start that was given.
  std::unique_ptr<NoiseEvaluator> take_evaluator() { return std::move(evaluator_); }
  const TuningOutcome& outcome() const { return outcome_; }
  /// What the last round's innovations from scan to scan take for the best k of the IMU, with deviations; none if
  /// that round's runs all diverged.
  const std::optional<LidarErrorFit>& scan_fit() const { return scan_fit_; }

 private:
  using Runs = std::shared_ptr<const std::vector<LinearisedTrial>>;

  /// Runs of the filter on the bags of `problem`, which are some of problem_'s, with a round of their own.
  std::vector<LinearisedTrial> run_filter(const NoiseProblem& problem, const NoiseSetting& at, const OnPhase& on_phase);
  /// Puts better runs in the place of those that are lost, if there are any. The setting to go on from.
  NoiseSetting better_beginning(std::vector<LinearisedTrial>& runs, const OnPhase& on_phase);
  double objective_of(const std::vector<LinearisedTrial>& runs) const;
  bool is_lost(const LinearisedTrial& run) const;
  bool is_better(const LinearisedTrial& run, const LinearisedTrial& than) const;
  void settle(const NoiseSetting& at, Runs runs, const std::vector<std::uint32_t>& bags, int round,
              const OnPhase& on_phase);
  void believe_the_runs();
  double mean_share() const;

  NoiseProblem problem_;
  LinearTuningOptions options_;
  std::vector<LinearRound> rounds_;
  bool at_rest_ = false, was_overruled_ = false;
  std::unique_ptr<NoiseEvaluator> evaluator_;
  TuningOutcome outcome_;
  std::optional<LidarErrorFit> scan_fit_;
};

}  // namespace allan_lio
