// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/calib/trial_problem.h"

namespace allan_lio {

/// Linear runs in a directory, so that a search that was interrupted goes on where it was, and that a worker on another
/// machine can hand one over. A file each, named by all that makes the run (TrialProblem::key); what find() gives has
/// the bits that put() got. Several threads and machines may use a directory at once.
class LinearRunFiles {
 public:
  /// Makes the directory if need be. `problem` must outlive it. Throws std::runtime_error naming the directory.
  LinearRunFiles(const TrialProblem& problem, std::string directory);

  const TrialProblem& problem() const { return problem_; }
  const std::string& directory() const { return directory_; }

  /// None if there is no file or if it is damaged, cut off or of another version: then it is to be run again.
  std::optional<LinearisedTrial> find(const NoiseTrial& trial) const;

  /// The file is there in one piece when it returns. Throws std::runtime_error naming the file.
  void put(const LinearisedTrial& linearised) const;

  /// What find() gives, or run and put.
  LinearisedTrial get(const NoiseTrial& trial) const;

 private:
  std::string name_of(const NoiseTrial& trial) const;

  const TrialProblem& problem_;
  std::string directory_;
};

}  // namespace allan_lio
