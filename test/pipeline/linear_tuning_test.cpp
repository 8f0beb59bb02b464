// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_tuning.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <random>
#include <set>

#include "prepared_drive.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr double kSeconds = 45.0;
constexpr std::uint64_t kSeed = 5;

/// 45 s of the rooms with an IMU that keeps to its specification, simulated once.
const TrialProblem& rooms() {
  static const TrialProblem problem = [] {
    const LioConfig config = simulated_robot();
    std::vector<TuningBag> bags;
    bags.push_back({"rooms", config, prepared(simulate_drive("rooms", kSeconds, 4), config)});
    return TrialProblem(std::move(bags), kSeed);
  }();
  return problem;
}

/// With two threads.
LinearTuningOptions options_of(const TrialProblem& problem, const TemporaryDirectory& directory) {
  LinearTuningOptions options;
  options.engine = make_linear_engine(problem, directory.path(), 2, nullptr);
  options.pool.jobs = 2;
  return options;
}

NoiseProblem of_white_noise(double start) {
  NoiseProblem problem;
  problem.tuned = {NoiseParameter::kKg, NoiseParameter::kKa};
  problem.start.imu.k_g = problem.start.imu.k_a = start;
  return problem;
}

TEST(LinearTuning, ALinearFilterWithTheRunsNoiseStaysWithTheRun) {
  const LinearisedTrial trial = rooms().run_linearised({});
  ASSERT_FALSE(trial.result.diverged);
  ASSERT_LT(trial.run.scans.size(), trial.result.scans) << "it begins where the standstill ends";
  ASSERT_GT(trial.run.scans.size(), trial.result.scans - 40);
  const LinearScore score = score_linear(trial.run, {}, {});
  // Not the same numbers: the run counts at the prediction, takes the view's error for known and has no drift.
  EXPECT_NEAR(score.nis / static_cast<double>(score.dof), trial.result.nis / static_cast<double>(trial.result.nis_dof),
              0.15);
  EXPECT_NEAR(score.horizon.nis / score.horizon.dof, trial.result.horizon_nis / trial.result.horizon_dof, 0.15);
  EXPECT_EQ(score.horizon.dof, trial.result.horizon_dof);
}

TEST(LinearTuning, ALinearisedRunIsTheRun) {
  const LinearisedTrial trial = rooms().run_linearised({});
  const TrialResult plain = rooms().run({});
  EXPECT_EQ(trial.result.nll, plain.nll);
  EXPECT_EQ(trial.result.horizon_nll, plain.horizon_nll);
}

TEST(LinearTuning, AnImuThatKeepsToItsSpecificationComesOutAsOneFromWhereverItBegins) {
  for (const double start : {0.1, 1.0, 30.0}) {
    const TemporaryDirectory directory;
    LinearTuningOptions options = options_of(rooms(), directory);
    int runs = 0;
    options.on_run = [&runs](const FinishedTrial&) { ++runs; };
    LinearTuning tuning(of_white_noise(start), options);
    ASSERT_TRUE(tuning.run({}));
    EXPECT_TRUE(tuning.at_rest());
    EXPECT_EQ(static_cast<std::size_t>(runs), tuning.rounds().size()) << "a run a round";
    // From far too small a k, with which the run is lost, a run with k = 3 is a better beginning.
    EXPECT_LE(tuning.rounds().size(), start < 1.0 ? 5U : 4U);
    EXPECT_EQ(tuning.rounds()[0].at.imu.k_g, start);
    const std::unique_ptr<NoiseEvaluator> evaluator = tuning.take_evaluator();
    const NoiseScale& found = evaluator->evaluations()[tuning.outcome().best].setting.imu;
    EXPECT_GT(found.k_g, 0.8) << start;
    EXPECT_LT(found.k_g, 1.25) << start;
    EXPECT_GT(found.k_a, 0.65) << start << ": 45 s tell it to some 15 %";
    EXPECT_LT(found.k_a, 1.5) << start;
    EXPECT_EQ(found.k_gb, 1.0) << "is not tuned";
    ASSERT_EQ(tuning.outcome().profiles.size(), 2U);
    EXPECT_EQ(tuning.outcome().profiles[0].verdict, ProfileVerdict::kTold);
    ASSERT_TRUE(tuning.scan_fit().has_value());
    EXPECT_GT(tuning.scan_fit()->setting.imu.k_g, 0.75);
    EXPECT_LT(tuning.scan_fit()->setting.imu.k_g, 1.25);
  }
}

/// 45 s of the rooms with so many times the gyro's specified white noise.
TuningBag noisy_rooms(double k_g) {
  const LioConfig config = simulated_robot();
  SimulatedDrive drive = simulate_drive("rooms", kSeconds, 4);
  std::mt19937_64 bits(3);
  std::normal_distribution<double> normal;
  const double rate = static_cast<double>(drive.imu.size()) / kSeconds;
  for (ImuSample& sample : drive.imu)
    for (int axis = 0; axis < 3; ++axis)
      sample.gyro[axis] += std::sqrt((k_g * k_g - 1.0) * rate) * config.imu.spec.gyro.white[axis] * normal(bits);
  return {"noisy rooms", config, prepared(drive, config)};
}

TEST(LinearTuning, ATooNoisyGyroIsToldByItsKAndLostRunsAreLeftBehind) {
  std::vector<TuningBag> bags;
  bags.push_back(noisy_rooms(4.0));
  const TrialProblem problem(std::move(bags), kSeed);
  const TemporaryDirectory directory;
  LinearTuningOptions options = options_of(problem, directory);
  options.plan.with_profiles = false;
  LinearTuning tuning(of_white_noise(1.0), options);
  ASSERT_TRUE(tuning.run({}));
  const NoiseScale found = tuning.rounds().back().found.imu;
  EXPECT_GT(found.k_g, 3.2);
  EXPECT_LT(found.k_g, 5.0);
  // With k = 1 the run's errors over seconds are four times what it claims: the next of all k alike is better.
  std::set<double> tried;
  for (const LinearRound& round : tuning.rounds()) tried.insert(round.at.imu.k_g);
  for (const double k : {1.0, 3.0}) EXPECT_EQ(tried.count(k), 1U) << k;
  for (const double k : {10.0, 30.0}) EXPECT_EQ(tried.count(k), 0U) << k << ": with 3 the run is not lost";
  EXPECT_EQ(tuning.rounds()[0].at.imu.k_g, 1.0);
  EXPECT_LT(tuning.rounds().back().objective, tuning.rounds()[0].objective) << "of the runs themselves";
}

TEST(LinearTuning, OnlyTheBagsWhoseRunsAreLostAreRunToFindABeginning) {
  std::vector<TuningBag> bags;
  bags.push_back({"rooms", simulated_robot(), prepared(simulate_drive("rooms", kSeconds, 4), simulated_robot())});
  bags.push_back(noisy_rooms(8.0));
  const TrialProblem trials(std::move(bags), kSeed);
  NoiseProblem problem = of_white_noise(1.0);
  problem.bags = {0, 1};
  const TemporaryDirectory directory;
  LinearTuningOptions options = options_of(trials, directory);
  options.plan.with_profiles = false;
  std::vector<NoiseTrial> run;
  options.on_run = [&run](const FinishedTrial& finished) { run.push_back(finished.trial); };
  LinearTuning tuning(problem, options);
  ASSERT_TRUE(tuning.run({}));
  const std::vector<LinearRound>& rounds = tuning.rounds();
  std::size_t of_one = 0;
  for (const LinearRound& round : rounds) {
    EXPECT_EQ(std::isfinite(round.objective), round.runs == 2U) << "a setting is judged by the runs of all bags";
    of_one += round.runs == 1 ? 1 : 0;
  }
  EXPECT_GE(of_one, 1U) << "the noisy bag is lost with k = 1";
  for (const NoiseTrial& trial : run)
    if (trial.setting.imu.k_g == 3.0 || trial.setting.imu.k_g == 10.0) EXPECT_EQ(trial.bag, 1U);
  // The runs of both bags, each from where it is not lost, say what the two need together.
  EXPECT_EQ(rounds.back().runs, 2U);
  EXPECT_GT(rounds.back().found.imu.k_g, 2.0);
  EXPECT_LT(rounds.back().found.imu.k_g, 8.0);
  EXPECT_TRUE(tuning.at_rest());
}

TEST(LinearTuning, WithoutASurvivingRunItKnowsNothing) {
  NoiseProblem problem = of_white_noise(1.0);
  const LioConfig config = simulated_robot();
  SimulatedDrive drive = simulate_drive("rooms", 12.0, 4);
  for (ImuSample& sample : drive.imu)
    if (seconds_between(drive.imu.front().stamp, sample.stamp) > 5.0) sample.accel.x() += 400.0;
  std::vector<TuningBag> bags;
  bags.push_back({"rooms", config, prepared(drive, config)});
  const TrialProblem trials(std::move(bags), kSeed);
  const TemporaryDirectory directory;
  LinearTuning tuning(problem, options_of(trials, directory));
  EXPECT_FALSE(tuning.run({}));
  ASSERT_EQ(tuning.rounds().size(), 4U) << "at the start and at 3, 10 and 30";
  for (const LinearRound& round : tuning.rounds()) EXPECT_EQ(round.diverged, 1U);
  problem.objective = TuningObjective::kAte;
  EXPECT_THROW(LinearTuning(problem, {}), std::invalid_argument);
}

TEST(LinearTuning, TheRunsOfAnEarlierRoundAreBelievedIfTheyAreMuchLikelier) {
  std::vector<LinearRound> rounds(4);
  rounds[0].objective = 500.0;
  rounds[1].objective = -119.0;
  rounds[2].objective = -117.0;
  rounds[3].objective = -110.0;
  EXPECT_EQ(believed_round(rounds), 3U) << "nine nats are chance";
  rounds[1].objective = -121.0;
  EXPECT_EQ(believed_round(rounds), 1U);
  EXPECT_EQ(believed_round({rounds[0]}), 0U);
}

TEST(LinearTuning, GoesAstrayWhereAFoundSettingsRunsAreMuchLessLikelyThanThoseFoundBefore) {
  const auto round = [](double at, double found, double objective) {
    LinearRound round;
    round.at.imu.k_g = at;
    round.found.imu.k_g = found;
    round.objective = objective;
    return round;
  };
  std::vector<LinearRound> rounds = {round(1.0, 2.0, -500.0), round(2.0, 3.0, -400.0)};
  EXPECT_FALSE(went_astray(rounds)) << "the first one found, from a start that may be far";
  rounds.push_back(round(3.0, 3.0, -391.0));
  EXPECT_FALSE(went_astray(rounds)) << "nine nats are chance";
  rounds.back().objective = -389.0;
  EXPECT_TRUE(went_astray(rounds));
  rounds[0].found.imu.k_g = 5.0;
  EXPECT_FALSE(went_astray(rounds)) << "the one before was not found, but tried to begin with";
  EXPECT_FALSE(went_astray({}));
}

TEST(LinearTuning, WhatIsInTheDirectoryIsNotRunAgainAndTheResultIsTheSame) {
  const TemporaryDirectory directory;
  std::vector<LinearRound> rounds[2];
  std::size_t stored[2] = {0, 0}, finished[2] = {0, 0};
  for (const int pass : {0, 1}) {
    LinearTuningOptions options = options_of(rooms(), directory);
    options.plan.with_profiles = false;
    options.on_run = [&](const FinishedTrial& trial) { ++finished[pass], stored[pass] += trial.stored ? 1 : 0; };
    LinearTuning tuning(of_white_noise(1.0), options);
    ASSERT_TRUE(tuning.run({}));
    rounds[pass] = tuning.rounds();
    const std::filesystem::directory_iterator files(directory.path());
    if (pass == 0) std::filesystem::remove(files->path());  // one of them is to be run again
  }
  EXPECT_EQ(stored[0], 0U);
  EXPECT_EQ(finished[1], finished[0]);
  EXPECT_EQ(stored[1], finished[0] - 1);
  ASSERT_EQ(rounds[1].size(), rounds[0].size());
  for (std::size_t i = 0; i < rounds[0].size(); ++i) {
    EXPECT_TRUE(same_setting(rounds[1][i].found, rounds[0][i].found)) << i;
    EXPECT_EQ(rounds[1][i].objective, rounds[0][i].objective) << i;
    EXPECT_EQ(rounds[1][i].errors.view, rounds[0][i].errors.view) << i;
  }
}

TEST(LinearTuning, StopsWhenAsked) {
  std::atomic<bool> stop{true};
  const TemporaryDirectory directory;
  LinearTuningOptions options;
  options.engine = make_linear_engine(rooms(), directory.path(), 1, &stop);
  options.pool.stop = &stop;
  LinearTuning tuning(of_white_noise(1.0), options);
  EXPECT_THROW(tuning.run({}), TrialsStopped);
}

}  // namespace
}  // namespace allan_lio
