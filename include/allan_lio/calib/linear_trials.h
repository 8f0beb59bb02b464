// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/calib/linear_likelihood.h"
#include "allan_lio/calib/linear_run_files.h"
#include "allan_lio/calib/noise_problem.h"
#include "allan_lio/calib/trial_pool.h"

namespace allan_lio {

/// Where runs of the filter are made, and where they leave their linear runs.
struct LinearEngine {
  std::shared_ptr<const LinearRunFiles> files;
  TrialEngine run;  ///< leaves the linear run of each of its trials in `files`
};

/// On `jobs` threads of this machine; the arguments as of make_trial_pool() and LinearRunFiles.
LinearEngine make_linear_engine(const TrialProblem& problem, const std::string& directory, int jobs,
                                const std::atomic<bool>* stop);

/// The problem's runs with one setting; those whose files are there already are not made again. `on_finished` (may be
/// empty) as cached() has it. Throws what the engine throws, and std::runtime_error if it left no linear run.
std::vector<LinearisedTrial> linearise(const LinearEngine& engine, const NoiseProblem& problem,
                                       const NoiseSetting& setting, const OnFinished& on_finished);

/// How threads are used on linear runs.
struct LinearPool {
  int jobs = 1;
  const std::atomic<bool>* stop = nullptr;
};

/// An engine that judges a trial on the linear run of the same bag and number: nll, nis and horizon figures of
/// LinearScore, no ate. Asked for a trial of which there is no linear run it throws std::invalid_argument.
TrialEngine make_linear_trials(std::shared_ptr<const std::vector<LinearisedTrial>> runs, const LidarErrors& errors,
                               LinearPool pool);

/// The registration's errors by maximum likelihood of the innovations from scan to scan, over all k of the IMU at once;
/// and those k, for what they are worth: of an IMU that keeps to its specification they are the best that can be had,
/// while one with errors of another kind is judged by its worst moments.
struct LidarErrorFit {
  LidarErrors errors;
  NoiseSetting setting;  ///< the k of the IMU found with them
  /// 1 sigma of ln k by the likelihood's curvature, in the order of k_g, k_a, k_gb, k_ab; infinite where it is flat.
  std::array<double, 4> deviations;
};

/// Where a fit begins, and how well it is to be done.
struct LidarErrorStart {
  NoiseSetting setting;  ///< that of the runs
  LidarErrors errors;
  bool warm = false;             ///< the errors are a former round's
  bool with_deviations = false;  ///< to a hundredth of a nat, with LidarErrorFit::deviations; else to half of one
};

/// The errors stay within a factor of three of what the filter reckons with (the drift's: ten of the usual one), lest
/// they take up what an IMU does that its model does not know. Log-normal priors, of which a factor of ten costs half a
/// nat (problem.prior_sigma for the k), decide where the runs do not tell. Throws std::invalid_argument if no run has a
/// scan.
LidarErrorFit fit_lidar_errors(const std::vector<LinearisedTrial>& runs, const NoiseProblem& problem,
                               const LidarErrorStart& start, LinearPool pool);

}  // namespace allan_lio
