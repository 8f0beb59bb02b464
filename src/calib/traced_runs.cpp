// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/traced_runs.h"

#include "allan_lio/calib/innovation_whiteness.h"
#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/calib/trial_pool.h"

namespace allan_lio {
namespace {

TracedRun trace(const TrialProblem& problem, const NoiseTrial& trial) {
  TracedRun traced;
  InnovationWhiteness whiteness;
  const TuningBag& bag = problem.bag_of(trial);
  traced.result = run_trial(bag.record, bag.config, trial, problem.seed(), [&](const LioResult& state) {
    whiteness.add(state.innovation);
    const RigidTransform& pose = state.state.nav.T_world_imu;
    if (pose.translation.allFinite() && pose.rotation.coeffs().allFinite())
      traced.trajectory.push_back({state.state.nav.stamp, pose});
  });
  if (!traced.result.diverged) traced.independent_share = whiteness.independent_share();
  return traced;
}

}  // namespace

std::vector<TracedRun> run_traced(const TrialProblem& problem, const NoiseSetting& setting, int jobs,
                                  const std::atomic<bool>* stop) {
  std::vector<NoiseTrial> trials;
  for (std::uint32_t bag = 0; bag < problem.bags().size(); ++bag) trials.push_back({bag, setting, 0});
  std::vector<TracedRun> runs(trials.size());
  const RunTrial run = [&](const NoiseTrial& trial) {
    runs[trial.bag] = trace(problem, trial);  // each thread another place
    return runs[trial.bag].result;
  };
  make_trial_pool(run, jobs, stop)(trials, {});
  return runs;
}

}  // namespace allan_lio
