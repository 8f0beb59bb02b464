// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "allan_lio/io/config_source.h"
#include "simulated_specs.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

std::vector<NoiseTrial> numbered(std::uint32_t count) {
  std::vector<NoiseTrial> trials(count);
  for (std::uint32_t i = 0; i < count; ++i) trials[i].run = i;
  return trials;
}

/// Takes longer for the early ones, so that they end out of order.
TrialResult square_of(const NoiseTrial& trial) {
  std::this_thread::sleep_for(std::chrono::microseconds(trial.run < 10 ? 3000 : 100));
  TrialResult result;
  result.ate = std::sqrt(static_cast<double>(trial.run));
  return result;
}

/// A problem whose trials are never run: it is there for the keys.
TrialProblem empty_problem(double leaf = 0.4) {
  std::vector<TuningBag> bags(1);
  bags[0].name = "corridor.bag";
  bags[0].config = default_config(mti600_spec());
  bags[0].config.lidar.leaf = leaf;
  return TrialProblem(std::move(bags), 1);
}

TEST(TrialPool, GivesResultsInTheTrialsOrderWhateverTheNumberOfJobs) {
  const std::vector<NoiseTrial> trials = numbered(60);
  for (const int jobs : {1, 2, 7, 100}) {
    std::vector<int> reported(trials.size(), 0);
    const auto results =
        make_trial_pool(square_of, jobs, nullptr)(trials, [&](std::size_t index, const TrialResult& result) {
          ++reported[index];
          EXPECT_EQ(result.ate, std::sqrt(static_cast<double>(index)));
        });
    ASSERT_EQ(results.size(), trials.size());
    for (std::size_t i = 0; i < trials.size(); ++i) EXPECT_EQ(results[i].ate, std::sqrt(static_cast<double>(i)));
    EXPECT_EQ(reported, std::vector<int>(trials.size(), 1)) << "each once";
  }
  EXPECT_TRUE(make_trial_pool(square_of, 2, nullptr)({}, {}).empty());
  EXPECT_THROW(make_trial_pool(square_of, 0, nullptr), std::invalid_argument);
}

TEST(TrialPool, AnErrorEndsTheBatchAndKeepsWhatWasDone) {
  std::size_t reported = 0;
  const RunTrial fails_at_twenty = [](const NoiseTrial& trial) {
    if (trial.run == 20) throw std::runtime_error("corridor.bag, run 20: no memory");
    return square_of(trial);
  };
  try {
    make_trial_pool(fails_at_twenty, 2, nullptr)(numbered(1000), [&](std::size_t, const TrialResult&) { ++reported; });
    FAIL() << "no error came";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "corridor.bag, run 20: no memory");
  }
  EXPECT_GE(reported, 19U);
  EXPECT_LE(reported, 30U);
}

TEST(TrialPool, StopsAfterWhatIsInFlight) {
  std::atomic<bool> stop{false};
  std::size_t reported = 0;
  const auto pool = make_trial_pool(square_of, 2, &stop);
  try {
    pool(numbered(1000), [&](std::size_t, const TrialResult&) { stop = ++reported >= 15; });
    FAIL() << "it did not stop";
  } catch (const TrialsStopped& stopped) {
    EXPECT_STREQ(stopped.what(), ("stopped after " + std::to_string(reported) + " of 1000 trials").c_str());
  }
  EXPECT_GE(reported, 15U);
  EXPECT_LE(reported, 16U) << "at most one more was in flight";
}

TEST(CachedTrials, RunNothingTwiceAndGoOnAfterAStop) {
  const TemporaryDirectory directory;
  TrialStore store(directory.file("trials.db"));
  const TrialProblem problem = empty_problem();
  const std::vector<NoiseTrial> trials = numbered(40);
  std::atomic<bool> stop{false};
  std::atomic<int> runs{0};
  const RunTrial counted = [&](const NoiseTrial& trial) { return ++runs, square_of(trial); };
  std::size_t stored = 0;
  const RunTrials run = cached(make_trial_pool(counted, 2, &stop), problem, &store, [&](const FinishedTrial& finished) {
    stored += finished.stored;
    EXPECT_EQ(finished.asked, 40U);
    if (finished.done == 12) stop = true;
  });
  EXPECT_THROW(run(trials), TrialsStopped);
  const int first = runs;
  EXPECT_EQ(store.size(), static_cast<std::size_t>(first)) << "everything that ended is in the store";
  EXPECT_LT(first, 20);
  stop = false;
  const RunTrials again = cached(make_trial_pool(counted, 2, &stop), problem, &store,
                                 [&](const FinishedTrial& finished) { stored += finished.stored; });
  const auto results = again(trials);
  EXPECT_EQ(runs, 40);
  EXPECT_EQ(stored, static_cast<std::size_t>(first));
  for (std::size_t i = 0; i < trials.size(); ++i) EXPECT_EQ(results[i].ate, std::sqrt(static_cast<double>(i)));
}

TEST(CachedTrials, AnotherConfigurationIsAnotherProblem) {
  const NoiseTrial trial;
  EXPECT_EQ(empty_problem().key(trial).problem, empty_problem().key(trial).problem);
  EXPECT_NE(empty_problem().key(trial).problem, empty_problem(0.3).key(trial).problem);
  std::vector<TuningBag> bags(1);
  bags[0].config = default_config(mti600_spec());
  bags[0].config.imu.scale.k_gb = 7.0;
  bags[0].config.lidar.k_r = 3.0;
  bags[0].config.threads = 4;
  EXPECT_EQ(TrialProblem(std::move(bags), 1).key(trial).problem, empty_problem().key(trial).problem)
      << "multipliers and threads are not part of it";
}

TEST(CachedTrials, NamesATrialByItsBagRunAndSetting) {
  NoiseTrial trial{0, {{1.0, 2.5, 10.0, 50.0}, 1.25}, 3};
  EXPECT_EQ(empty_problem().describe(trial), "corridor.bag, run 3, k_g 1, k_a 2.5, k_gb 10, k_ab 50, k_r 1.25");
  trial.bag = 1;
  EXPECT_THROW(empty_problem().key(trial), std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
