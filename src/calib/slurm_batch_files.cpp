// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slurm_batch_files.h"

#include <stdlib.h>

#include <deque>
#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>

#include "allan_lio/io/whole_file.h"
#include "slurm_queue.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

std::string submission_name(std::size_t submission) { return "submission-" + std::to_string(submission); }

}  // namespace

SlurmBatchFiles::SlurmBatchFiles(const std::string& parent) : directory_(parent + "/batch-XXXXXX") {
  std::error_code ignored;
  fs::create_directories(parent, ignored);
  if (mkdtemp(&directory_[0]) == nullptr) throw std::runtime_error(directory_ + ": cannot be made");
}

void SlurmBatchFiles::remove() const {
  std::error_code ignored;
  fs::remove_all(directory_, ignored);
}

std::string SlurmBatchFiles::job_name() const { return "allan_lio-" + fs::path(directory_).filename().string(); }

std::string SlurmBatchFiles::file(const std::string& task, const std::string& kind) const {
  return directory_ + "/task-" + task + "." + kind;
}

std::string SlurmBatchFiles::log(std::size_t task, std::size_t submission) const {
  return file(std::to_string(task), submission_name(submission) + ".log");
}

std::string SlurmBatchFiles::log_pattern(std::size_t submission) const {
  std::string pattern;
  for (const char c : directory_) pattern += c == '%' ? std::string("%%") : std::string(1, c);
  return pattern + "/task-%a." + submission_name(submission) + ".log";
}

/// A failure leaves a file, so that it can be told from results that the shared directory does not show yet.
std::string SlurmBatchFiles::write_script(const std::string& worker, std::size_t submission) const {
  const std::string path = directory_ + "/" + submission_name(submission) + ".sh";
  const std::string task = shell_quoted(directory_ + "/task-") + "\"$SLURM_ARRAY_TASK_ID\"";
  write_whole(path, "#!/bin/sh\nTRIALS=" + task + ".trials\nRESULTS=" + task + ".results\nexport TRIALS RESULTS\n(\n" +
                        worker + "\n)\nstatus=$?\n" + "[ $status -eq 0 ] && exit 0\n" +
                        "echo \"the worker ended with status $status\"\n: >" + task + "." +
                        submission_name(submission) + ".failed\nexit 1\n");
  return path;
}

/// By the directory's listing, which a network file system shows fresher than single names.
std::vector<bool> SlurmBatchFiles::with_results(std::size_t count) const {
  std::set<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) names.insert(entry.path().string());
  std::vector<bool> there(count);
  for (std::size_t i = 0; i < count; ++i) there[i] = names.count(results(i)) > 0;
  return there;
}

bool SlurmBatchFiles::failed(std::size_t task, std::size_t submission) const {
  return fs::exists(file(std::to_string(task), submission_name(submission) + ".failed"));
}

std::string last_lines(const std::string& path, std::size_t count) {
  std::ifstream in(path);
  if (!in) return "  (there is no such file)";
  std::deque<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
    if (lines.size() > count) lines.pop_front();
  }
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "  " : "\n  ") + line;
  return text.empty() ? "  (it is empty)" : text;
}

}  // namespace allan_lio
