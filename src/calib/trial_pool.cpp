// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_pool.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace allan_lio {
namespace {

/// One batch on its way through the threads.
class Batch {
 public:
  Batch(const std::vector<NoiseTrial>& trials, const RunTrial& run, const OnTrial& on_trial,
        const std::atomic<bool>* stop)
      : trials_(trials), run_(run), on_trial_(on_trial), stop_(stop), results_(trials.size()) {}

  /// What each thread does.
  void work() {
    for (std::size_t index; (index = next()) < trials_.size();) {
      try {
        const TrialResult result = run_(trials_[index]);
        const std::lock_guard<std::mutex> lock(mutex_);
        results_[index] = result;
        ++done_;
        if (on_trial_) on_trial_(index, result);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!error_ || index < failed_) error_ = std::current_exception(), failed_ = index;
      }
    }
  }

  /// When no thread works any more.
  std::vector<TrialResult> finish() {
    if (error_) std::rethrow_exception(error_);
    if (done_ < trials_.size()) throw TrialsStopped(done_, trials_.size());
    return std::move(results_);
  }

 private:
  /// The next trial, or one past the last.
  std::size_t next() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (error_ || (stop_ != nullptr && stop_->load()) || next_ == trials_.size()) return trials_.size();
    return next_++;
  }

  const std::vector<NoiseTrial>& trials_;
  const RunTrial& run_;
  const OnTrial& on_trial_;
  const std::atomic<bool>* stop_;
  std::mutex mutex_;
  std::vector<TrialResult> results_;
  std::size_t next_ = 0, done_ = 0;
  std::exception_ptr error_;
  std::size_t failed_ = 0;  ///< the earliest trial with an error
};

}  // namespace

TrialsStopped::TrialsStopped(std::size_t done, std::size_t asked)
    : std::runtime_error("stopped after " + std::to_string(done) + " of " + std::to_string(asked) + " trials") {}

TrialEngine make_trial_pool(RunTrial run, int jobs, const std::atomic<bool>* stop) {
  if (jobs < 1) throw std::invalid_argument("a pool of trials needs at least one job, not " + std::to_string(jobs));
  return [run = std::move(run), jobs, stop](const std::vector<NoiseTrial>& trials, const OnTrial& on_trial) {
    Batch batch(trials, run, on_trial, stop);
    std::vector<std::thread> threads;
    for (std::size_t i = 1; i < std::min(static_cast<std::size_t>(jobs), trials.size()); ++i)
      threads.emplace_back([&batch] { batch.work(); });
    batch.work();
    for (std::thread& thread : threads) thread.join();
    return batch.finish();
  };
}

TrialEngine make_trial_pool(const TrialProblem& problem, int jobs, const std::atomic<bool>* stop) {
  return make_trial_pool([&problem](const NoiseTrial& trial) { return problem.run(trial); }, jobs, stop);
}

RunTrials cached(TrialEngine engine, const TrialProblem& problem, TrialStore* store, OnFinished on_finished) {
  return [engine = std::move(engine), &problem, store,
          on_finished = std::move(on_finished)](const std::vector<NoiseTrial>& trials) {
    std::vector<TrialResult> results(trials.size());
    std::vector<std::size_t> missing;  // places in `trials`
    std::vector<NoiseTrial> to_run;
    std::size_t done = 0;
    const auto finish = [&](std::size_t index, const TrialResult& result, bool stored) {
      results[index] = result;
      ++done;
      if (on_finished) on_finished({trials[index], result, stored, done, trials.size()});
    };
    for (std::size_t i = 0; i < trials.size(); ++i) {
      const std::optional<TrialResult> known = store ? store->find(problem.key(trials[i])) : std::nullopt;
      if (known) {
        finish(i, *known, true);
      } else {
        missing.push_back(i);
        to_run.push_back(trials[i]);
      }
    }
    engine(to_run, [&](std::size_t place, const TrialResult& result) {
      if (store) store->put(problem.key(to_run[place]), result);
      finish(missing[place], result, false);
    });
    return results;
  };
}

}  // namespace allan_lio
