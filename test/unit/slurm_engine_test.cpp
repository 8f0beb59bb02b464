// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/slurm_engine.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <thread>

#include "child_process.h"
#include "fake_slurm.h"
#include "temporary_directory.h"
#include "trial_worker.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

constexpr double kPoll = 0.03, kGrace = 0.3;  // [s]

/// A shared directory and options for it, with a worker that does its work.
struct SlurmEngine : testing::Test {
  SlurmEngine() {
    options.directory = shared.file("a directory's name");
    options.worker = echo_worker();
    options.trials_per_task = 3;
    options.poll_interval = kPoll;
    options.grace = kGrace;
  }

  /// A worker that fails the first time at the task that holds this trial of different_trials.
  void fail_once(std::uint32_t run) {
    options.worker = "grep -q '," + std::to_string(1000 + run) + ",' \"$TRIALS\" && [ ! -e " + fake.state("failed") +
                     " ] && touch " + fake.state("failed") + " && exit 3\n" + echo_worker();
  }

  std::string complaint(std::uint32_t trials) {
    try {
      make_slurm_engine(options)(different_trials(trials));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  std::size_t submissions() {
    std::size_t count = 0;
    const std::string calls = contents_of(fake.state("calls"));
    for (std::size_t at = 0; (at = calls.find("sbatch ", at)) != std::string::npos; ++at) ++count;
    return count;
  }

  FakeSlurm fake;
  TemporaryDirectory shared;
  SlurmOptions options;
};

TEST_F(SlurmEngine, ReturnsResultsInTheTrialsOrderAndLeavesNothingBehind) {
  std::size_t told = 0;
  options.on_result = [&told](const NoiseTrial& trial, const TrialResult& result) {
    told += trial.run == result.scans && trial.setting.imu.k_g == result.ate ? 1 : 0;
  };
  const std::vector<NoiseTrial> trials = different_trials(10);
  const RunTrials run = make_slurm_engine(options);
  expect_echo(run(trials), trials);
  EXPECT_EQ(told, trials.size());
  EXPECT_NE(contents_of(fake.state("calls")).find("--array=0-3 "), std::string::npos);
  EXPECT_TRUE(fs::is_empty(options.directory));
  expect_echo(run(different_trials(1)), different_trials(1));
  EXPECT_TRUE(run({}).empty());
  EXPECT_EQ(submissions(), 2U);
}

TEST_F(SlurmEngine, SubmitsAFailedTaskAgainWithoutTheOthers) {
  fail_once(4);
  options.grace = 1000.0;  // the failure says so itself
  const std::vector<NoiseTrial> trials = different_trials(10);
  expect_echo(make_slurm_engine(options)(trials), trials);
  EXPECT_TRUE(fake.has("failed"));
  EXPECT_NE(contents_of(fake.state("calls")).find("--array=1 "), std::string::npos);
}

TEST_F(SlurmEngine, SubmitsTasksAgainThatVanished) {
  fake.set("lose_0");
  fake.set("lose_2");
  const std::vector<NoiseTrial> trials = different_trials(10);
  expect_echo(make_slurm_engine(options)(trials), trials);
  EXPECT_NE(contents_of(fake.state("calls")).find("--array=0,2 "), std::string::npos);
}

TEST_F(SlurmEngine, TakesATaskOutOfAHoldThatSlurmWouldKeepForEver) {
  fake.set("hold_1");
  const std::vector<NoiseTrial> trials = different_trials(6);
  expect_echo(make_slurm_engine(options)(trials), trials);
  EXPECT_NE(contents_of(fake.state("calls")).find("scancel 10_1"), std::string::npos);
}

TEST_F(SlurmEngine, NamesTheTaskThatFailsInAllAttemptsAndWhatItsLogSays) {
  options.worker = "grep -q ,1004, \"$TRIALS\" && echo 'no such bag: kitchen.bag' && exit 3\n" + echo_worker();
  std::atomic<int> told{0};
  options.on_result = [&told](const NoiseTrial&, const TrialResult&) { ++told; };
  const std::string text = complaint(10);
  EXPECT_NE(text.find("task 1 (trials 3 to 5) failed in 3 attempts"), std::string::npos) << text;
  EXPECT_NE(text.find("task-1.submission-3.log"), std::string::npos) << text;
  EXPECT_NE(text.find("no such bag: kitchen.bag\n  the worker ended with status 3"), std::string::npos) << text;
  EXPECT_EQ(submissions(), 3U);
  EXPECT_EQ(told, 7) << "what the other tasks computed is not lost";
  EXPECT_TRUE(fake.has("cancelled"));
  EXPECT_FALSE(fs::is_empty(options.directory)) << "the logs stay";
}

TEST_F(SlurmEngine, CancelsTheJobWhenItIsStopped) {
  options.worker =
      "while [ -d " + fake.state("queue") + " ] && [ ! -e " + fake.state("cancelled") + " ]; do sleep 0.02; done";
  std::atomic<bool> stop{false};
  options.stop = &stop;
  options.poll_interval = 1000.0;  // not waited for
  std::future<std::vector<TrialResult>> results =
      std::async(std::launch::async, [this] { return make_slurm_engine(options)(different_trials(4)); });
  while (!fake.has("queue/1")) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  stop = true;
  EXPECT_THROW(results.get(), SlurmStopped);
  EXPECT_TRUE(fake.has("cancelled"));
}

TEST_F(SlurmEngine, SaysWhatToInstallWithoutSbatch) {
  const TemporaryDirectory empty;
  const ScopedVariable path("PATH", empty.path());
  EXPECT_NE(complaint(1).find("install the package slurm-client"), std::string::npos);
}

TEST_F(SlurmEngine, PassesOnWhatSbatchObjectsTo) {
  fake.set("sbatch_fails");
  options.sbatch_arguments = {"--partition=moon"};
  EXPECT_NE(complaint(1).find("invalid partition specified: moon"), std::string::npos);
  EXPECT_NE(contents_of(fake.state("calls")).find("--partition=moon"), std::string::npos);
}

TEST_F(SlurmEngine, OutlivesAQueueThatIsSilentForAWhileButNotForEver) {
  fake.set("squeue_fails");
  const std::vector<NoiseTrial> trials = different_trials(4);
  expect_echo(make_slurm_engine(options)(trials), trials);
  options.worker = "exit 1";
  options.patience = 5 * kPoll;
  EXPECT_NE(complaint(1).find("Unable to contact slurm controller"), std::string::npos);
}

TEST_F(SlurmEngine, RefusesResultsThatAreNotWhatTheTrialsAskFor) {
  options.worker = "echo garbage >\"$RESULTS\"";
  EXPECT_NE(complaint(1).find("task-0.results: is no file of 'allan_lio results 2'"), std::string::npos);
  options.worker = echo_worker() + "\nsed -i -e '$d' -e 's/ 3 rows/ 2 rows/' \"$RESULTS\"";
  options.worker = "RESULTS=$RESULTS.short\n" + options.worker + "\nmv $RESULTS ${RESULTS%.short}";
  options.directory = shared.file("plain");
  EXPECT_NE(complaint(3).find("task-0.results: the worker wrote 2 results of 3 trials"), std::string::npos);
}

TEST_F(SlurmEngine, GivesTasksMoreTrialsWhereTheArrayWouldBeTooLarge) {
  options.max_tasks = 2;
  const std::vector<NoiseTrial> trials = different_trials(9);
  expect_echo(make_slurm_engine(options)(trials), trials);
  EXPECT_NE(contents_of(fake.state("calls")).find("--array=0-1 "), std::string::npos);
}

TEST_F(SlurmEngine, RefusesOptionsThatMakeNoSense) {
  options.worker = "";
  EXPECT_THROW(make_slurm_engine(options), std::invalid_argument);
  options.worker = "true";
  options.directory = "not/absolute";
  EXPECT_THROW(make_slurm_engine(options), std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
