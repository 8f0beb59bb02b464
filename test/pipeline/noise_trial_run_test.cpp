// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_trial_run.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstring>

#include "allan_lio/calib/run_perturbation.h"
#include "allan_lio/calib/trial_pool.h"
#include "allan_lio/eval/trajectory_error.h"
#include "prepared_drive.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr std::uint64_t kSeed = 5;

bool same_bits(const TrialResult& a, const TrialResult& b) {
  return std::memcmp(&a.ate, &b.ate, sizeof(double)) == 0 && a.end_error == b.end_error && a.nll == b.nll &&
         a.nis == b.nis && a.nis_dof == b.nis_dof && a.horizon_nll == b.horizon_nll && a.horizon_nis == b.horizon_nis &&
         a.horizon_dof == b.horizon_dof && a.horizon_share == b.horizon_share && a.scans == b.scans &&
         a.diverged == b.diverged;
}

NoiseTrial run_number(std::uint32_t run, NoiseSetting setting = {}) { return {0, setting, run}; }

/// 12 s of the rooms, simulated once.
class NoiseTrialRun : public ::testing::Test {
 protected:
  static const SimulatedDrive& drive() {
    static const SimulatedDrive drive = simulate_drive("rooms", 12.0, 4);
    return drive;
  }
  static const PreparedRecord& record() {
    static const PreparedRecord record = prepared(drive(), simulated_robot());
    return record;
  }
  TrialResult run(const NoiseTrial& trial, std::uint64_t seed = kSeed) const {
    return run_trial(record(), config, trial, seed);
  }
  const LioConfig config = simulated_robot();
};

TEST_F(NoiseTrialRun, TheFirstRunIsThatOfTheOdometryOnTheWholeDrive) {
  LioConfig louder = config;
  louder.imu.scale.k_ab = 30.0;
  louder.lidar.k_r = 1.5;
  const std::vector<LioResult> whole = run_odometry(drive(), louder);
  std::vector<LioResult> seen;
  const NoiseSetting setting{{1.0, 1.0, 1.0, 30.0}, 1.5};
  const TrialResult result = run_trial(record(), config, run_number(0, setting), kSeed,
                                       [&](const LioResult& state) { seen.push_back(state); });
  ASSERT_EQ(seen.size(), whole.size());
  double nis = 0.0, nll = 0.0;
  std::uint64_t dof = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    EXPECT_EQ(seen[i].state.nav.T_world_imu.translation, whole[i].state.nav.T_world_imu.translation);
    EXPECT_EQ(seen[i].covariance, whole[i].covariance);
    const PoseInnovation& z = whole[i].innovation;
    nis += z.nis;
    dof += static_cast<std::uint64_t>(z.dof);
    nll += 0.5 * (z.nis + z.log_det + z.dof * std::log(2.0 * M_PI));
  }
  const TrajectoryError error = evaluate_trajectory(drive().truth, trajectory_of(whole), Alignment::kSe3);
  EXPECT_FALSE(result.diverged);
  EXPECT_EQ(result.scans, whole.size());
  EXPECT_EQ(result.ate, error.translation.rmse);
  EXPECT_EQ(result.end_error, error.end_drift);
  EXPECT_EQ(result.nis, nis);
  EXPECT_EQ(result.nis_dof, dof);
  EXPECT_NEAR(result.nll, nll, 1e-9 * std::abs(nll));
  EXPECT_LT(result.ate, 0.02);
}

TEST_F(NoiseTrialRun, RepeatsItselfAndDiffersBetweenRunsAndSeeds) {
  const TrialResult as_it_is = run(run_number(0)), first = run(run_number(1)), second = run(run_number(2));
  EXPECT_TRUE(same_bits(first, run(run_number(1))));
  EXPECT_TRUE(same_bits(as_it_is, run(run_number(0), kSeed + 1))) << "nothing is drawn for run 0";
  EXPECT_NE(first.ate, second.ate);
  EXPECT_NE(first.ate, as_it_is.ate);
  EXPECT_NE(first.ate, run(run_number(1), kSeed + 1).ate);
  for (const TrialResult& result : {first, second}) {
    EXPECT_FALSE(result.diverged);
    EXPECT_LT(result.ate, 0.02) << "still a sane run";
    EXPECT_LE(result.scans, as_it_is.scans);
    EXPECT_GE(result.scans + 11, as_it_is.scans) << "a second of scans at the start, and hardly ever one later";
  }
}

TEST_F(NoiseTrialRun, WithoutATruthThereIsNoErrorButTheSameLikelihood) {
  const PreparedRecord blind = prepared(drive(), config, false);
  const TrialResult result = run_trial(blind, config, run_number(0), kSeed);
  EXPECT_TRUE(std::isnan(result.ate));
  EXPECT_TRUE(std::isnan(result.end_error));
  EXPECT_EQ(result.nll, run(run_number(0)).nll);
}

TEST_F(NoiseTrialRun, TheLikelihoodPrefersTheTrueNoiseToOneTenTimesOff) {
  const double at_truth = run(run_number(0)).nll;
  EXPECT_LT(at_truth, run(run_number(0, {{10.0, 10.0, 1.0, 1.0}, 1.0})).nll);
  EXPECT_LT(at_truth, run(run_number(0, {{0.1, 0.1, 1.0, 1.0}, 1.0})).nll);
}

TEST_F(NoiseTrialRun, OverSecondsItPrefersTheTrueNoiseToOneThreeTimesOff) {
  const PreparedRecord longer = prepared(simulate_drive("rooms", 70.0, 4), config);
  const auto with = [&](double k) { return run_trial(longer, config, run_number(0, {{k, k, 1.0, 1.0}, 1.0}), kSeed); };
  const TrialResult at_truth = with(1.0);
  EXPECT_LT(at_truth.horizon_nll, with(0.3).horizon_nll);
  EXPECT_LT(at_truth.horizon_nll, with(3.0).horizon_nll);
  EXPECT_NEAR(at_truth.horizon_nis / at_truth.horizon_dof, 1.0, 0.5);
  EXPECT_GT(at_truth.horizon_dof, 100.0);
}

TEST_F(NoiseTrialRun, ALostMapIsWorseThanAnySaneRunAndStillFinite) {
  SimulatedDrive lost = drive();
  for (std::size_t i = 60; i < lost.scans.size(); ++i)  // elsewhere all of a sudden
    for (ScanPoint& p : lost.scans[i].points) p.x += 40.0F, p.y += 40.0F, p.z += 40.0F;
  const PreparedRecord record = prepared(lost, config);
  const TrialResult result = run_trial(record, config, run_number(0), kSeed);
  EXPECT_TRUE(result.diverged);
  EXPECT_TRUE(std::isinf(result.ate));
  EXPECT_TRUE(std::isfinite(result.nll));
  EXPECT_GT(result.nll, kWorstScanNll * static_cast<double>(record.scans()));
  EXPECT_EQ(result.horizon_nll, result.nll);
  EXPECT_LT(result.scans, 80U) << "it ends there";
  EXPECT_TRUE(std::isfinite(result.nis));
}

TEST_F(NoiseTrialRun, ImpossibleReadingsDivergeAndScoreFinite) {
  SimulatedDrive thrown = drive();
  for (std::size_t i = 800; i < thrown.imu.size(); ++i) thrown.imu[i].accel.setConstant(280.0);  // just under 50 g
  const TrialResult result = run_trial(prepared(thrown, config), config, run_number(0), kSeed);
  EXPECT_TRUE(result.diverged);
  EXPECT_TRUE(std::isfinite(result.nll));
}

TEST_F(NoiseTrialRun, NoScanAtAllIsNoGoodRun) {
  SimulatedDrive late = drive();
  for (ImuSample& sample : late.imu) sample.stamp += 3600 * kNsPerSecond;  // after all scans
  const TrialResult result = run_trial(prepared(late, config, false), config, run_number(0), kSeed);
  EXPECT_TRUE(result.diverged);
  EXPECT_EQ(result.scans, 0U);
}

TEST_F(NoiseTrialRun, OneJobAndTwoGiveTheSameBits) {
  std::vector<TuningBag> bags;
  bags.push_back({"rooms", config, prepared(drive(), config)});
  const TrialProblem problem(std::move(bags), kSeed);
  std::vector<NoiseTrial> trials;
  for (const double k : {0.3, 1.0, 30.0})
    for (std::uint32_t run = 0; run < 2; ++run) trials.push_back(run_number(run, {{1.0, 1.0, k, k}, 1.0}));
  const auto alone = make_trial_pool(problem, 1, nullptr)(trials, {});
  const auto two = make_trial_pool(problem, 2, nullptr)(trials, {});
  ASSERT_EQ(alone.size(), trials.size());
  for (std::size_t i = 0; i < trials.size(); ++i) {
    EXPECT_TRUE(same_bits(alone[i], two[i])) << problem.describe(trials[i]);
    EXPECT_TRUE(same_bits(alone[i], run(trials[i])));
  }
}

TEST_F(NoiseTrialRun, ASearchThatIsKilledGoesOnWhereItWasAndEndsWithTheSameBits) {
  constexpr std::size_t kJobs = 2, kBeforeTheKill = 4;
  const TemporaryDirectory directory;
  const std::string path = directory.file("trials.db");
  std::vector<TuningBag> bags;
  bags.push_back({"rooms", config, prepared(drive(), config)});
  const TrialProblem problem(std::move(bags), kSeed);
  std::vector<NoiseTrial> trials;
  for (std::uint32_t run = 0; run < 10; ++run) trials.push_back(run_number(run, {{1.0, 1.0, 3.0, 3.0}, 1.0}));

  const pid_t child = fork();
  if (child == 0) {
    try {
      TrialStore store(path);
      std::size_t stored = 0;
      const auto kill_itself = [&stored](const FinishedTrial&) {  // while the other thread is at a trial
        if (++stored == kBeforeTheKill) kill(getpid(), SIGKILL);
      };
      cached(make_trial_pool(problem, kJobs, nullptr), problem, &store, kill_itself)(trials);
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));

  TrialStore store(path);
  ASSERT_EQ(store.size(), kBeforeTheKill);
  std::size_t from_the_store = 0;
  const auto count = [&from_the_store](const FinishedTrial& finished) { from_the_store += finished.stored; };
  const auto resumed = cached(make_trial_pool(problem, kJobs, nullptr), problem, &store, count)(trials);
  EXPECT_EQ(from_the_store, kBeforeTheKill);
  for (std::size_t i = 0; i < trials.size(); ++i) EXPECT_TRUE(same_bits(resumed[i], run(trials[i]))) << i;
}

TEST_F(NoiseTrialRun, TheRecordGivesItsScansBackAndItsDigestSeesEveryPart) {
  ScanDownsampler downsampler;
  const Scan thin = thin_scan(drive().scans[17], config.map.insert_leaf, config.lidar.leaf, downsampler);
  const Scan back = record().scan(17);
  ASSERT_EQ(back.points.size(), thin.points.size());
  for (std::size_t i = 0; i < thin.points.size(); ++i) {
    EXPECT_EQ(back.points[i].x, thin.points[i].x);
    EXPECT_EQ(back.points[i].offset_ns, thin.points[i].offset_ns);
  }
  EXPECT_EQ(back.registered, thin.registered);
  EXPECT_EQ(back.begin(), thin.begin());
  EXPECT_EQ(back.end(), thin.end());
  EXPECT_EQ(record().digest(), prepared(drive(), config).digest());
  EXPECT_NE(record().digest(), prepared(drive(), config, false).digest());
  SimulatedDrive other = drive();
  other.imu.back().gyro.z() += 1e-15;
  EXPECT_NE(record().digest(), prepared(other, config).digest());
  other = drive();
  other.scans.back().points.front().y += 1e-5F;
  EXPECT_NE(record().digest(), prepared(other, config).digest());
}

TEST_F(NoiseTrialRun, ATruthThatCannotServeIsRefused) {
  PreparedRecord record = prepared(drive(), config, false);
  Trajectory early = drive().truth, still = drive().truth;
  for (StampedPose& pose : early) pose.stamp -= 7 * kNsPerSecond;
  for (StampedPose& pose : still) pose.pose.translation.setZero();
  EXPECT_THROW(record.set_reference(early), std::runtime_error);
  EXPECT_THROW(record.set_reference(still), std::runtime_error);
  EXPECT_TRUE(record.reference().empty());
}

TEST(RunPerturbation, LosesTheSharesThatItStates) {
  constexpr std::size_t kMany = 200000;
  const RunPerturbation run(1, 2, 3), as_it_is(1, 2, 0);
  std::size_t samples = 0, scans = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    samples += !run.keeps_sample(i);
    scans += !run.keeps_scan(i, 10.0);
    ASSERT_TRUE(as_it_is.keeps_sample(i) && as_it_is.keeps_scan(i, 0.0));
  }
  const auto within_five_sigma = [](std::size_t count, double share) {
    return std::abs(static_cast<double>(count) - share * kMany) < 5.0 * std::sqrt(share * kMany);
  };
  EXPECT_TRUE(within_five_sigma(samples, RunPerturbation::kLostSamples)) << samples;
  EXPECT_TRUE(within_five_sigma(scans, RunPerturbation::kLostScans)) << scans;
}

TEST(RunPerturbation, TakesPacketsOutAndLeavesTheRunAsItIsAlone) {
  Scan whole;
  whole.last_offset_ns = 100'000'000;
  for (int i = 0; i < 20000; ++i) {
    const double angle = 2.0 * M_PI * i / 20000.0;
    whole.points.push_back({static_cast<float>(5.0 * std::cos(angle)), static_cast<float>(5.0 * std::sin(angle)),
                            0.1F * static_cast<float>(i % 16), 0.0F, 5000 * i});
  }
  ScanDownsampler downsampler;
  const Scan thin = thin_scan(whole, 0.01, 0.2, downsampler);
  double lost = 0.0;
  constexpr int kScans = 400;
  for (int i = 0; i < kScans; ++i) {
    Scan scan = thin;
    RunPerturbation(1, 2, 3).apply(static_cast<std::size_t>(i), 0.2, downsampler, scan);
    lost += 1.0 - static_cast<double>(scan.points.size()) / static_cast<double>(thin.points.size());
    for (const std::uint32_t index : scan.registered) ASSERT_LT(index, scan.points.size());
  }
  EXPECT_NEAR(lost / kScans, RunPerturbation::kLostPackets, 0.004);
  Scan same = thin;
  RunPerturbation(1, 2, 0).apply(0, 0.2, downsampler, same);
  EXPECT_EQ(same.points.size(), thin.points.size());
  EXPECT_EQ(same.registered, thin.registered);
}

}  // namespace
}  // namespace allan_lio
