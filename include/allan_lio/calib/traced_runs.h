// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <vector>

#include "allan_lio/calib/trial_problem.h"

namespace allan_lio {

/// A run with what a table of results does not keep.
struct TracedRun {
  TrialResult result;
  Trajectory trajectory;           ///< as far as it is finite
  double independent_share = 1.0;  ///< InnovationWhiteness of its innovations; 1 if it diverged
};

/// Run 0 of every bag with the setting, `jobs` at a time. Throws TrialsStopped where `stop` (may be null) is raised.
std::vector<TracedRun> run_traced(const TrialProblem& problem, const NoiseSetting& setting, int jobs,
                                  const std::atomic<bool>* stop);

}  // namespace allan_lio
