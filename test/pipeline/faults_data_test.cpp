// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Messages that are wrong, injected into a bag: dropped, counted, said, and the trajectory stays good.
#include <gtest/gtest.h>

#include "faulty_run.h"

namespace allan_lio {
namespace {

constexpr int kScans = SimulatedBag::kScans;
constexpr double kAteBound = 0.015;  // [m], as of the bag without faults; 0.0015 to 0.0022 measured

TEST(FaultyData, SenselessAndFarPointsAreDroppedAndCounted) {
  const FaultyRun run({"points_invalid"});
  run.expect_in_order();
  constexpr int kPoints = kScans * 28800;  // of a VLP-16, all of which hit the rooms' walls
  EXPECT_EQ(run.points("invalid"), kPoints * 3 / 10);
  EXPECT_EQ(run.points("out_of_range"), kPoints * 2 / 10);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, EmptyAndThinScansLeaveItToTheImuAndTheStatesSaySo) {
  const FaultyRun run({"scans_empty", "scans_thin"});
  run.expect_in_order();
  EXPECT_EQ(run.skipped("too_few_points"), 8) << "every 40th is empty, every 50th thin";
  EXPECT_EQ(run.rows_with("too_few_points"), 8);
  EXPECT_EQ(run.trajectory().size(), static_cast<std::size_t>(kScans)) << "the IMU goes on alone";
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, CloudsWhoseHeadersLieAreDroppedAndCounted) {
  const FaultyRun run({"scans_lie"});
  run.expect_in_order();
  EXPECT_NE(run.notes().find("10 messages could not be decoded; the last: the cloud's header does not match"),
            std::string::npos)
      << run.notes();
  EXPECT_EQ(run.scans("used"), kScans - 10);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, RepeatedAndBackwardImuStampsAreDroppedAndCounted) {
  const FaultyRun run({"imu_repeated", "imu_backward"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("dropped_not_newer"), run.imu("samples") - SimulatedBag::kImuSamples);
  EXPECT_GT(run.imu("dropped_not_newer"), 60);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, RepeatedAndBackwardScansAreDroppedAndCounted) {
  const FaultyRun run({"lidar_repeated", "lidar_backward"});
  run.expect_in_order();
  EXPECT_EQ(run.skipped("not_newer_than_the_last"), run.scans("read") - kScans);
  EXPECT_GT(run.skipped("not_newer_than_the_last"), 10);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, OneStampFromTheFutureOfEachCostsThisMessageOnly) {
  const FaultyRun run({"imu_from_the_future", "lidar_from_the_future"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("dropped_not_newer"), 1);
  EXPECT_EQ(run.skipped("not_newer_than_the_last"), 1);
  EXPECT_EQ(run.scans("used"), kScans - 1);
  EXPECT_EQ(run.notes().find("started again"), std::string::npos) << run.notes();
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, SenselessImuValuesAreDroppedAndCounted) {
  const FaultyRun run({"imu_senseless"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("dropped_invalid"), SimulatedBag::kImuSamples / 90);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
}

TEST(FaultyData, ASaturatedGyroIsCountedAndTrustedLess) {
  const FaultyRun trusted({"imu_saturated"});
  const FaultyRun run({"imu_saturated"}, "--param imu/gyro_range=" + std::to_string(kClippedRate));
  run.expect_in_order();
  EXPECT_GT(run.imu("saturated"), 400);
  EXPECT_EQ(trusted.imu("saturated"), 0);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
  EXPECT_GT(ate_of(trusted.trajectory()), 0.1) << "0.54 measured";
}

TEST(FaultyData, ASaturatedAccelerometerIsCountedAndTrustedLess) {
  const FaultyRun trusted({"imu_saturated_accel"});
  const FaultyRun run({"imu_saturated_accel"}, "--param imu/accel_range=" + std::to_string(kClippedAccel));
  run.expect_in_order();
  EXPECT_GT(run.imu("saturated"), 400);
  EXPECT_EQ(trusted.imu("saturated"), 0);
  EXPECT_EQ(run.scans("used"), kScans);
  EXPECT_LT(ate_of(run.trajectory()), kAteBound);
  EXPECT_GT(ate_of(trusted.trajectory()), 0.1) << "6.2 measured";
}

TEST(FaultyData, AllOfThemAtOnceAreSurvived) {
  const FaultyRun run({"points_invalid", "scans_empty", "scans_thin", "scans_lie", "imu_repeated", "imu_backward",
                       "imu_from_the_future", "lidar_repeated", "lidar_backward", "imu_senseless", "imu_gap_bridged"});
  run.expect_in_order();
  EXPECT_EQ(run.imu("gaps"), 1);
  EXPECT_GT(run.scans("used"), kScans * 9 / 10);
  EXPECT_LT(ate_of(run.trajectory()), 0.03);
}

}  // namespace
}  // namespace allan_lio
