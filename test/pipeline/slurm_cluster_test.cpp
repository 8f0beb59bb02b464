// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slurm_cluster.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <future>
#include <thread>

#include "allan_lio/calib/slurm_engine.h"
#include "child_process.h"
#include "temporary_directory.h"
#include "trial_worker.h"

namespace allan_lio {
namespace {

constexpr double kPoll = 0.1, kGrace = 1.0;  // [s]

/// The engine against a real slurmctld and slurmd; needs the package slurm-wlm.
struct RealSlurm : testing::Test {
  void SetUp() override {
    if (!SlurmCluster::installed()) GTEST_SKIP() << "slurmctld is not installed (package slurm-wlm)";
    cluster = std::make_unique<SlurmCluster>();
    options.directory = shared.file("it's 100%a shared");
    options.worker = echo_worker();
    options.trials_per_task = 3;
    options.poll_interval = kPoll;
    options.grace = kGrace;
  }

  /// Shell words that are true once in the task that holds this trial of different_trials.
  std::string once_at(std::uint32_t run, const std::string& name) const {
    return "grep -q '," + std::to_string(1000 + run) + ",' \"$TRIALS\" && mkdir '" + shared.file(name) + "' 2>&1";
  }

  bool happened(const std::string& name) const { return std::filesystem::exists(shared.file(name)); }

  TemporaryDirectory shared;
  std::unique_ptr<SlurmCluster> cluster;
  SlurmOptions options;
};

TEST_F(RealSlurm, RunsTheTrialsAgainOfTasksThatFailOrAreTakenAway) {
  options.worker = once_at(1, "failed") + " && exit 3\n" + once_at(4, "cancelled") +
                   " && scancel ${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID && sleep 100\n" + echo_worker();
  const std::vector<NoiseTrial> trials = different_trials(10);
  expect_echo(make_slurm_engine(options)(trials), trials);
  EXPECT_TRUE(happened("failed"));
  EXPECT_TRUE(happened("cancelled"));
  EXPECT_TRUE(std::filesystem::is_empty(options.directory));
}

TEST_F(RealSlurm, QuotesTheLogOfATaskThatFailsForGood) {
  options.worker = "echo 'no such bag: kitchen.bag' >&2; exit 3";
  options.attempts = 2;
  try {
    make_slurm_engine(options)(different_trials(1));
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("failed in 2 attempts"), std::string::npos) << text;
    EXPECT_NE(text.find("no such bag: kitchen.bag"), std::string::npos) << text;
  }
}

TEST_F(RealSlurm, EmptiesTheQueueWhenItIsStopped) {
  options.worker = "mkdir '" + shared.file("running") + "'; sleep 100";
  std::atomic<bool> stop{false};
  options.stop = &stop;
  std::future<std::vector<TrialResult>> results =
      std::async(std::launch::async, [this] { return make_slurm_engine(options)(different_trials(9)); });
  while (!happened("running")) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  stop = true;
  EXPECT_THROW(results.get(), SlurmStopped);
  EXPECT_EQ(run_command("squeue --noheader --states=PENDING,RUNNING").text, "");
}

TEST_F(RealSlurm, RefusesAPartitionThatIsNotThere) {
  options.sbatch_arguments = {"--partition=moon"};
  EXPECT_THROW(make_slurm_engine(options)(different_trials(1)), std::runtime_error);
}

}  // namespace
}  // namespace allan_lio
