// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/slurm_engine.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>

#include "allan_lio/io/trial_files.h"
#include "slurm_batch_files.h"
#include "slurm_queue.h"

namespace allan_lio {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLogLines = 10;     // of a failed task's log in the error
constexpr std::size_t kSubmitRounds = 3;  // sbatch fails in passing when the controller is busy or restarts
constexpr double kStopLatency = 0.05;     // [s]

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One part of the batch, the same for every attempt at it.
struct Task {
  std::size_t begin = 0, end = 0;  ///< trials
  std::size_t attempts = 0;        ///< begun
  std::size_t submission = 0;      ///< the latest
  bool done = false;
  bool gone = false;             ///< from the queue, without results
  Clock::time_point gone_since;  ///< where it is
};

class SlurmBatch {
 public:
  SlurmBatch(const SlurmOptions& options, const std::vector<NoiseTrial>& trials);
  ~SlurmBatch();
  SlurmBatch(const SlurmBatch&) = delete;
  SlurmBatch& operator=(const SlurmBatch&) = delete;

  std::vector<TrialResult> run();

 private:
  void submit(const std::vector<std::size_t>& tasks);
  void submit_once(const std::vector<std::size_t>& tasks);
  void wait(double seconds) const;
  bool queue_answers(std::set<std::size_t>* queued);
  void gather();
  void take(std::size_t task);
  std::vector<std::size_t> lost_tasks(const std::set<std::size_t>& queued);
  [[noreturn]] void give_up(std::size_t task) const;

  const SlurmOptions& options_;
  const std::vector<NoiseTrial>& trials_;
  SlurmBatchFiles files_;
  SlurmQueue queue_;
  std::vector<Task> tasks_;
  std::vector<TrialResult> results_;
  std::size_t open_ = 0;  // tasks without results
  std::size_t submissions_ = 0;
  Clock::time_point last_answer_ = Clock::now();
};

SlurmBatch::SlurmBatch(const SlurmOptions& options, const std::vector<NoiseTrial>& trials)
    : options_(options),
      trials_(trials),
      files_(options.directory),
      queue_(files_.job_name()),
      results_(trials.size()) {
  const std::size_t fewest = (trials.size() + options.max_tasks - 1) / options.max_tasks;
  const std::size_t share = std::max(options.trials_per_task, fewest);
  for (std::size_t begin = 0; begin < trials.size(); begin += share) {
    Task task;
    task.begin = begin;
    task.end = std::min(begin + share, trials.size());
    tasks_.push_back(task);
    write_trials(files_.trials(tasks_.size() - 1), {trials.begin() + static_cast<std::ptrdiff_t>(task.begin),
                                                    trials.begin() + static_cast<std::ptrdiff_t>(task.end)});
  }
  open_ = tasks_.size();
}

SlurmBatch::~SlurmBatch() {
  // After more than one submission a task may still run although its results are here.
  const bool running = submissions_ > (open_ == 0 ? 1U : 0U);
  try {
    if (running) queue_.cancel();
  } catch (const std::exception&) {  // the error on its way out tells more
  }
  if (open_ == 0) files_.remove();
}

std::vector<TrialResult> SlurmBatch::run() {
  std::vector<std::size_t> all(tasks_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  submit(all);
  while (open_ > 0) {
    wait(options_.poll_interval);
    // The queue is asked before the results are looked for: a task that has left it by then has written them.
    std::set<std::size_t> queued;
    const bool answered = queue_answers(&queued);
    gather();
    if (answered) submit(lost_tasks(queued));
  }
  return std::move(results_);
}

void SlurmBatch::submit(const std::vector<std::size_t>& tasks) {
  if (tasks.empty()) return;
  for (const std::size_t i : tasks)
    if (tasks_[i].attempts == options_.attempts) give_up(i);
  for (std::size_t round = 1;; ++round) try {
      return submit_once(tasks);
    } catch (const std::runtime_error&) {
      if (round == kSubmitRounds) throw;
      wait(options_.poll_interval);
    }
}

void SlurmBatch::submit_once(const std::vector<std::size_t>& tasks) {
  ++submissions_;
  const std::string script = files_.write_script(options_.worker, submissions_);
  queue_.submit(script, tasks, files_.log_pattern(submissions_), options_.sbatch_arguments);
  for (const std::size_t i : tasks) {
    ++tasks_[i].attempts;
    tasks_[i].submission = submissions_;
    tasks_[i].gone = false;
  }
}

void SlurmBatch::wait(double seconds) const {
  for (const Clock::time_point start = Clock::now();;) {
    if (options_.stop != nullptr && *options_.stop) throw SlurmStopped("stopped; the Slurm job is cancelled");
    const double left = seconds - seconds_since(start);
    if (left <= 0.0) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(std::min(left, kStopLatency)));
  }
}

bool SlurmBatch::queue_answers(std::set<std::size_t>* queued) {
  std::string trouble;
  if (queue_.list(queued, &trouble)) {
    last_answer_ = Clock::now();
    return true;
  }
  if (seconds_since(last_answer_) > options_.patience)
    throw std::runtime_error("squeue has not answered for too long; the last it said: " + trouble);
  return false;
}

void SlurmBatch::gather() {
  const std::vector<bool> there = files_.with_results(tasks_.size());
  for (std::size_t i = 0; i < tasks_.size(); ++i)
    if (!tasks_[i].done && there[i]) take(i);
}

void SlurmBatch::take(std::size_t task) {
  const std::size_t begin = tasks_[task].begin, count = tasks_[task].end - begin;
  const std::string path = files_.results(task);
  const std::vector<TrialResult> results = read_results(path);
  if (results.size() != count)
    throw std::runtime_error(path + ": the worker wrote " + std::to_string(results.size()) + " results of " +
                             std::to_string(count) + " trials");
  std::copy(results.begin(), results.end(), results_.begin() + static_cast<std::ptrdiff_t>(begin));
  if (options_.on_result)
    for (std::size_t i = 0; i < count; ++i) options_.on_result(trials_[begin + i], results[i]);
  tasks_[task].done = true;
  --open_;
}

std::vector<std::size_t> SlurmBatch::lost_tasks(const std::set<std::size_t>& queued) {
  std::vector<std::size_t> lost;
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    Task& task = tasks_[i];
    if (task.done) continue;
    const bool gone = queued.count(i) == 0;
    if (gone && !task.gone) task.gone_since = Clock::now();
    task.gone = gone;
    const bool failed = files_.failed(i, task.submission);
    if (gone && (failed || seconds_since(task.gone_since) >= options_.grace)) lost.push_back(i);
  }
  return lost;
}

void SlurmBatch::give_up(std::size_t task) const {
  const Task& t = tasks_[task];
  const std::string log = files_.log(task, t.submission);
  throw std::runtime_error("Slurm task " + std::to_string(task) + " (trials " + std::to_string(t.begin) + " to " +
                           std::to_string(t.end - 1) + ") failed in " + std::to_string(t.attempts) +
                           " attempts; its log " + log + " ends:\n" + last_lines(log, kLogLines));
}

}  // namespace

RunTrials make_slurm_engine(SlurmOptions options) {
  if (!std::filesystem::path(options.directory).is_absolute())
    throw std::invalid_argument("the directory shared with Slurm's nodes must be an absolute path, it is '" +
                                options.directory + "'");
  if (options.worker.empty() || options.attempts == 0 || options.trials_per_task == 0 || options.max_tasks == 0)
    throw std::invalid_argument("the Slurm engine needs a worker, and at least one attempt, trial a task, and task");
  const auto shared = std::make_shared<const SlurmOptions>(std::move(options));
  return [shared](const std::vector<NoiseTrial>& trials) {
    return trials.empty() ? std::vector<TrialResult>() : SlurmBatch(*shared, trials).run();
  };
}

}  // namespace allan_lio
