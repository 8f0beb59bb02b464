// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/calib/linear_trials.h"
#include "allan_lio/calib/slurm_engine.h"
#include "allan_lio/calib/trial_pool.h"
#include "allan_lio/calib/trial_problem.h"

namespace allan_lio {

/// Writes all that a worker on another machine needs to run trials of the problem as files into a directory, which is
/// made if need be: the prepared records, the configurations, and a file that names them, whose path is returned. Their
/// names tell their content: several problems may share the directory, and a record that lies there is not written
/// again. Throws std::runtime_error naming the file.
std::string write_worker_problem(const std::string& directory, const TrialProblem& problem);

/// What a worker does: runs the trials in the file `trials` one after the other and writes their results to `results`
/// (trial_files.h); with `linear_runs`, the directory of a LinearRunFiles, their linear runs go there. The same trials,
/// the same bits as in the process that wrote `problem`. Throws std::runtime_error naming file or trial, also if this
/// is another build of the program, whose results must not be mixed with its own.
void run_worker(const std::string& problem, const std::string& trials, const std::string& results,
                const std::string& linear_runs = "");

/// The Slurm engine for cached(): writes the problem into options.directory (which must be absolute) and sets worker
/// and on_result. `program`: what is called with --worker, --trials and --results, and then does run_worker(). Where it
/// is stopped it throws TrialsStopped. Throws as make_slurm_engine and write_worker_problem.
TrialEngine make_slurm_trials(const TrialProblem& problem, SlurmOptions options, const std::string& program);

/// The same with linear runs, for which `program` is called with --linear-runs too: in options.directory/linear.
LinearEngine make_slurm_linear_engine(const TrialProblem& problem, SlurmOptions options, const std::string& program);

}  // namespace allan_lio
