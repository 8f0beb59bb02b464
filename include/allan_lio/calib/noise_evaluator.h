// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "allan_lio/calib/noise_problem.h"
#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

/// A setting with what its runs gave.
struct ScoredSetting {
  NoiseSetting setting;
  /// Lower is better. kAte: the average of the runs' ATE [m]. A likelihood: nll_scale times the sum over the bags of
  /// the runs' average nll_of, plus prior_cost [nats]: the negative log posterior but for a constant.
  double objective = 0.0;
  double prior = 0.0;               ///< prior_cost, the part of the objective that is not the data's
  double run_deviation = 0.0;       ///< standard deviation among the runs, of each run's objective over all bags
  std::uint32_t diverged = 0;       ///< runs
  std::vector<TrialResult> trials;  ///< bag by bag, in each run by run
};

/// What the paper prints of repeated runs [m]; diverged runs count as in the objective.
struct AteRange {
  double max = 0.0, min = 0.0, average = 0.0;
};

/// Over all bags and runs.
AteRange ate_range(const NoiseProblem& problem, const ScoredSetting& scored);
/// Over the runs of one bag; `index` is its place in problem.bags.
AteRange ate_range(const NoiseProblem& problem, const ScoredSetting& scored, std::size_t index);

/// Judges settings by running their trials, each setting once. Keeps all of them, so that an engine that throws in the
/// midst of a search loses none of those before.
class NoiseEvaluator {
 public:
  /// Throws std::invalid_argument as check_problem does.
  NoiseEvaluator(NoiseProblem problem, RunTrials run_trials);

  const NoiseProblem& problem() const { return problem_; }

  /// Runs the settings that are new as one batch. Gives each setting's place in evaluations(). Throws what the engine
  /// throws, and std::runtime_error if the objective is kAte and not one of the runs had ground truth.
  std::vector<std::size_t> evaluate(const std::vector<NoiseSetting>& settings);
  std::size_t evaluate(const NoiseSetting& setting) { return evaluate(std::vector<NoiseSetting>{setting}).front(); }

  /// In the order of their evaluation.
  const std::vector<ScoredSetting>& evaluations() const { return evaluations_; }

  /// The place of the lowest objective, of equal ones the first. Throws std::logic_error if nothing was evaluated.
  std::size_t best() const;

 private:
  std::size_t find(const NoiseSetting& setting) const;

  NoiseProblem problem_;
  RunTrials run_trials_;
  std::vector<ScoredSetting> evaluations_;
};

/// The setting on other bags than those tuned on, judged in the same way.
ScoredSetting score(const NoiseProblem& problem, const RunTrials& run_trials, const NoiseSetting& setting,
                    const std::vector<std::uint32_t>& bags);

}  // namespace allan_lio
