// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_trials.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace allan_lio {

namespace {

constexpr std::chrono::seconds kShown{30};  ///< until a network file system shows what a worker has written

/// What a worker has made.
LinearisedTrial fetch(const LinearRunFiles& files, const NoiseTrial& trial) {
  const auto since = std::chrono::steady_clock::now();
  for (;;) {
    if (std::optional<LinearisedTrial> found = files.find(trial)) return std::move(*found);
    if (std::chrono::steady_clock::now() - since > kShown) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  throw std::runtime_error(files.problem().describe(trial) + ": the run left no linear run in " + files.directory());
}

}  // namespace

LinearEngine make_linear_engine(const TrialProblem& problem, const std::string& directory, int jobs,
                                const std::atomic<bool>* stop) {
  auto files = std::make_shared<const LinearRunFiles>(problem, directory);
  const RunTrial run = [files](const NoiseTrial& trial) { return files->get(trial).result; };
  return {files, make_trial_pool(run, jobs, stop)};
}

std::vector<LinearisedTrial> linearise(const LinearEngine& engine, const NoiseProblem& problem,
                                       const NoiseSetting& setting, const OnFinished& on_finished) {
  std::vector<LinearisedTrial> runs;
  for (const std::uint32_t bag : problem.bags)
    for (std::uint32_t run = 0; run < problem.runs; ++run) runs.push_back({{bag, setting, run}, {}, {}});
  std::size_t done = 0;
  const auto finish = [&](const NoiseTrial& trial, const TrialResult& result, bool stored) {
    ++done;
    if (on_finished) on_finished({trial, result, stored, done, runs.size()});
  };
  std::vector<NoiseTrial> to_run;
  std::vector<std::size_t> places;  // of those in `runs`
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (std::optional<LinearisedTrial> known = engine.files->find(runs[i].trial)) {
      runs[i] = std::move(*known);
      finish(runs[i].trial, runs[i].result, true);
    } else {
      to_run.push_back(runs[i].trial);
      places.push_back(i);
    }
  }
  if (to_run.empty()) return runs;
  engine.run(to_run, [&](std::size_t i, const TrialResult& result) { finish(to_run[i], result, false); });
  for (std::size_t i = 0; i < to_run.size(); ++i) runs[places[i]] = fetch(*engine.files, to_run[i]);
  return runs;
}

TrialEngine make_linear_trials(std::shared_ptr<const std::vector<LinearisedTrial>> runs, const LidarErrors& errors,
                               LinearPool pool) {
  const RunTrial run = [runs = std::move(runs), errors](const NoiseTrial& trial) {
    const auto same = [&trial](const LinearisedTrial& other) {
      return other.trial.bag == trial.bag && other.trial.run == trial.run && !other.run.scans.empty();
    };
    const auto found = std::find_if(runs->begin(), runs->end(), same);
    if (found == runs->end())
      throw std::invalid_argument("there is no linear run of bag " + std::to_string(trial.bag) + ", run " +
                                  std::to_string(trial.run));
    const LinearScore score = score_linear(found->run, trial.setting, errors);
    TrialResult result;
    result.scans = static_cast<std::uint32_t>(found->run.scans.size());
    result.diverged = !std::isfinite(score.nll) || !std::isfinite(score.horizon.nll);
    result.nll = result.diverged ? kWorstScanNll * result.scans : score.nll;
    result.horizon_nll = result.diverged ? kWorstScanNll * result.scans : score.horizon.nll;
    result.nis = score.nis;
    result.nis_dof = score.dof;
    result.horizon_nis = score.horizon.nis;
    result.horizon_dof = score.horizon.dof;
    result.horizon_share = score.horizon.independent_share;
    return result;
  };
  return make_trial_pool(run, pool.jobs, pool.stop);
}

}  // namespace allan_lio
