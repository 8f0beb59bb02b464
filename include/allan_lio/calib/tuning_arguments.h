// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_tuning.h"

namespace allan_lio {

/// tune_noise's options as they are written; empty texts and zeros were not given.
struct TuningArguments {
  std::vector<std::string> bags, references;  ///< --bag, --reference
  std::vector<std::string> hold_out, hold_out_references;
  std::string suite, seeds, only, hold_out_seeds;
  std::string config, out, records;
  std::vector<std::string> overrides;  ///< --param
  std::string parameters, search = "likelihood", objective, grid, order, start, box, profile, nll_scale = "auto";
  double prior_sigma = 0.0;
  std::uint32_t runs = 1;
  std::uint64_t seed = 1, budget = 0;
  bool rerun = false;
  int jobs = 0;
  std::string engine = "local", slurm_directory;
  std::vector<std::string> slurm_arguments;
  double slurm_poll = 2.0;                           ///< [s]
  std::string worker, trials, results, linear_runs;  ///< of a Slurm task
};

/// Throws std::invalid_argument with a sentence that names the options that do not go together or are missing.
void check_arguments(const TuningArguments& a);

TuningSearch search_of(const TuningArguments& a);

/// nll for likelihood and bayes without references, ate for grid and sequential, unless --objective says otherwise.
/// Throws std::invalid_argument for another word.
TuningObjective objective_of(const TuningArguments& a);

/// `configured`: the noise of the configuration, where a search starts unless --start says otherwise; `bags`: those
/// tuned on. Both throw std::invalid_argument naming the option or the coefficient.
NoiseProblem problem_of(const TuningArguments& a, const NoiseSetting& configured, std::uint32_t bags);
TuningPlan plan_of(const TuningArguments& a, const NoiseProblem& problem);

}  // namespace allan_lio
