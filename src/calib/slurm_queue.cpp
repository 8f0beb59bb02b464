// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slurm_queue.h"

#include <sys/wait.h>

#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr int kNotFound = 127;  // the shell's status for a command that does not exist

/// "0-3,7": an array of a thousand tasks must fit on a command line.
std::string ranges_of(const std::vector<std::size_t>& tasks) {
  std::string text;
  for (std::size_t i = 0; i < tasks.size();) {
    std::size_t last = i;
    while (last + 1 < tasks.size() && tasks[last + 1] == tasks[last] + 1) ++last;
    text += (text.empty() ? "" : ",") + std::to_string(tasks[i]);
    if (last > i) text += "-" + std::to_string(tasks[last]);
    i = last + 1;
  }
  return text;
}

/// Reasons for which Slurm keeps a task in the queue without ever starting it again by itself.
bool held_for_good(const std::string& reason) {
  return reason.find("launch failed") != std::string::npos || reason.find("JobHoldMaxRequeue") != std::string::npos ||
         reason.find("launch_failed") != std::string::npos;
}

}  // namespace

CommandOutcome run_shell(const std::string& command) {
  CommandOutcome outcome;
  FILE* pipe = popen(("{ " + command + "\n} 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start: " + command);
  char buffer[65536];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.text.append(buffer, n);
  const int status = pclose(pipe);
  if (status != -1 && WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

void SlurmQueue::submit(const std::string& script, const std::vector<std::size_t>& tasks,
                        const std::string& log_pattern, const std::vector<std::string>& more_arguments) const {
  std::string command = "sbatch --parsable --job-name=" + shell_quoted(job_name_) + " --array=" + ranges_of(tasks) +
                        " --output=" + shell_quoted(log_pattern) + " --open-mode=append";
  for (const std::string& argument : more_arguments) command += " " + shell_quoted(argument);
  const CommandOutcome outcome = run_shell(command + " " + shell_quoted(script));
  if (outcome.status == 0) return;
  if (outcome.status == kNotFound)
    throw std::runtime_error(
        "the command sbatch is not there; install the package slurm-client (Debian, Ubuntu) on "
        "this machine, or use the local engine");
  throw std::runtime_error("sbatch did not take the job: " + outcome.text);
}

bool SlurmQueue::list(std::set<std::size_t>* tasks, std::string* trouble) const {
  const std::string name = shell_quoted(job_name_);
  const CommandOutcome outcome = run_shell("squeue --noheader --array --name=" + name + " --format='task %K %F_%K %r'");
  *trouble = outcome.text;
  if (outcome.status != 0) return false;
  std::istringstream lines(outcome.text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string mark, job, reason;
    std::size_t task = 0;
    if (!(words >> mark >> task >> job) || mark != "task") continue;  // squeue's warnings stand among its lines
    std::getline(words, reason);
    if (held_for_good(reason)) {
      run_shell("scancel " + shell_quoted(job));
    } else {
      tasks->insert(task);
    }
  }
  return true;
}

void SlurmQueue::cancel() const { run_shell("scancel --name=" + shell_quoted(job_name_)); }

}  // namespace allan_lio
