// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_trials.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "allan_lio/calib/noise_trial_run.h"

namespace allan_lio {

std::vector<LinearisedTrial> linearise(const TrialProblem& trials, const NoiseProblem& problem,
                                       const NoiseSetting& setting, int jobs, const std::atomic<bool>* stop,
                                       const OnTrial& on_trial) {
  std::vector<NoiseTrial> asked;
  for (const std::uint32_t bag : problem.bags)
    for (std::uint32_t run = 0; run < problem.runs; ++run) asked.push_back({bag, setting, run});
  std::vector<LinearisedTrial> runs(asked.size());
  const RunTrial run = [&](const NoiseTrial& trial) {
    const auto bag = std::find(problem.bags.begin(), problem.bags.end(), trial.bag) - problem.bags.begin();
    LinearisedTrial& place = runs[static_cast<std::size_t>(bag) * problem.runs + trial.run];  // each thread another
    place = trials.run_linearised(trial);
    return place.result;
  };
  make_trial_pool(run, jobs, stop)(asked, on_trial);
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
