// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace allan_lio {

/// The files of one batch, in a directory of its own: results of a batch that died must never be taken for another's.
class SlurmBatchFiles {
 public:
  /// Makes the directory in `parent`.
  explicit SlurmBatchFiles(const std::string& parent);

  void remove() const;

  /// Told from all other batches, by the directory's name.
  std::string job_name() const;

  std::string trials(std::size_t task) const { return file(std::to_string(task), "trials"); }
  std::string results(std::size_t task) const { return file(std::to_string(task), "results"); }
  std::string log(std::size_t task, std::size_t submission) const;

  /// The same for sbatch, which puts in the task's number.
  std::string log_pattern(std::size_t submission) const;

  /// Writes the job script that runs `worker` and returns its path.
  std::string write_script(const std::string& worker, std::size_t submission) const;

  /// Of `count` tasks, which have results.
  std::vector<bool> with_results(std::size_t count) const;

  /// Whether the script says that its worker failed.
  bool failed(std::size_t task, std::size_t submission) const;

 private:
  std::string file(const std::string& task, const std::string& kind) const;

  std::string directory_;
};

/// The last lines of a file, indented; says so if there is none.
std::string last_lines(const std::string& path, std::size_t count);

}  // namespace allan_lio
