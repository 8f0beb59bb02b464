// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <vector>

#include "allan_lio/calib/noise_trial.h"
#include "allan_lio/calib/trial_problem.h"
#include "allan_lio/io/trial_store.h"

namespace allan_lio {

/// Thrown by an engine that was asked to stop: what was in flight is finished and reported, the rest is not begun.
class TrialsStopped : public std::runtime_error {
 public:
  TrialsStopped(std::size_t done, std::size_t asked);
};

/// Gets every result as it is there: the trial's place in the batch and its result. Calls do not overlap; they come
/// from any thread and in any order.
using OnTrial = std::function<void(std::size_t index, const TrialResult&)>;

/// Runs a batch of trials and reports each one as it ends.
using TrialEngine = std::function<std::vector<TrialResult>(const std::vector<NoiseTrial>&, const OnTrial&)>;

/// Runs one trial; several threads call it at once.
using RunTrial = std::function<TrialResult(const NoiseTrial&)>;

/// Trials on `jobs` threads of this machine, each of which takes the next trial when it has finished one: the results
/// do not depend on their number. The first error ends the batch when what is in flight is done, and is rethrown; so
/// does `stop`, which may be null and must outlive the engine, with TrialsStopped.
TrialEngine make_trial_pool(RunTrial run, int jobs, const std::atomic<bool>* stop);

/// TrialProblem::run(), which must outlive the engine.
TrialEngine make_trial_pool(const TrialProblem& problem, int jobs, const std::atomic<bool>* stop);

/// What a progress display and a table of trials want to know of a result.
struct FinishedTrial {
  NoiseTrial trial;
  TrialResult result;
  bool stored = false;    ///< it was in the store already
  std::size_t done = 0;   ///< of this batch, this one included
  std::size_t asked = 0;  ///< in this batch
};
using OnFinished = std::function<void(const FinishedTrial&)>;

/// The engine behind a store, if there is one: what is in it is not run again, every other result is put there as soon
/// as it is there. `problem` and `store` must outlive it. `on_finished` (may be empty): as OnTrial, those of the store
/// first.
RunTrials cached(TrialEngine engine, const TrialProblem& problem, TrialStore* store, OnFinished on_finished);

}  // namespace allan_lio
