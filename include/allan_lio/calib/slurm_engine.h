// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

struct SlurmOptions {
  /// Seen under this absolute path by this machine and by the nodes. Each batch makes a directory of its own in it,
  /// which goes when the batch is complete and stays, with the logs, when it fails.
  std::string directory;
  /// Shell command that reads the trials in the file "$TRIALS" (read_trials) and writes as many results, in their
  /// order, to the file "$RESULTS" (write_results): "tune_noise --worker F --trials $TRIALS --results $RESULTS".
  std::string worker;
  std::vector<std::string> sbatch_arguments;  ///< more of the user's own: --partition=long, --time=30
  std::size_t trials_per_task = 8;            ///< more where the batch would need more than max_tasks tasks
  std::size_t max_tasks = 1000;               ///< of an array job; the cluster's MaxArraySize less 1
  std::size_t attempts = 3;                   ///< at a task, the first included
  double poll_interval = 2.0;                 ///< [s]
  double grace = 30.0;      ///< from a task's leaving the queue until its results are taken for lost [s]
  double patience = 300.0;  ///< for which the queue may give no answer, as when the controller restarts [s]
  /// Called with each result as soon as its task has ended, in no certain order: what must not be lost with the batch.
  std::function<void(const NoiseTrial&, const TrialResult&)> on_result;
  const std::atomic<bool>* stop = nullptr;  ///< where it turns true the job is cancelled and SlurmStopped thrown
};

/// The batch was given up because the stop flag was raised.
struct SlurmStopped : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// An engine that hands every batch of trials to Slurm as an array job and waits for its results. A task that fails,
/// is pre-empted, or vanishes is submitted again. Throws std::runtime_error, with the job cancelled, if a task fails in
/// all attempts (naming its trials, its log, and the log's last lines) or if Slurm cannot be used. Throws
/// std::invalid_argument at once if the options make no sense.
RunTrials make_slurm_engine(SlurmOptions options);

}  // namespace allan_lio
