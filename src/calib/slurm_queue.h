// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/io/run_program.h"

namespace allan_lio {

struct CommandOutcome {
  int status = -1;   ///< exit status; -1 if a signal ended it
  std::string text;  ///< what it printed, errors included
};

CommandOutcome run_shell(const std::string& command);

/// Slurm's commands, about all jobs of one name: after a lost answer to sbatch nobody knows the job's number.
class SlurmQueue {
 public:
  explicit SlurmQueue(std::string job_name) : job_name_(std::move(job_name)) {}

  /// Throws std::runtime_error with sbatch's words if it refuses.
  void submit(const std::string& script, const std::vector<std::size_t>& tasks, const std::string& log_pattern,
              const std::vector<std::string>& more_arguments) const;

  /// The tasks that wait or run, into `tasks`; those that Slurm holds back for good are cancelled and left out. False,
  /// with squeue's words in `trouble`, if it gives no answer.
  bool list(std::set<std::size_t>* tasks, std::string* trouble) const;

  void cancel() const;

 private:
  std::string job_name_;
};

}  // namespace allan_lio
