// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/math/so3.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr double kDuration = 40.0;                 // [s] of the rooms
constexpr double kWrongTurn = 1.0 * M_PI / 180.0;  // [rad]
constexpr double kWrongShift = 0.02;               // [m]
// Measured over four seeds: 0.11 to 0.20 deg and 10 to 18 mm are left of 1 deg and 20 mm; the trajectory's error falls
// to about a quarter.
constexpr double kTurnLeft = 0.4 * M_PI / 180.0;  // [rad]
constexpr double kErrorLeft = 0.6;                // of the trajectory's error without estimation

double turn_between(const RigidTransform& a, const RigidTransform& b) {
  return log_so3(a.rotation.conjugate() * b.rotation).norm();
}

double shift_between(const RigidTransform& a, const RigidTransform& b) {
  return (a.translation - b.translation).norm();
}

class Extrinsics : public ::testing::Test {
 protected:
  static LioConfig wrong_robot() {
    LioConfig config = simulated_robot();
    RigidTransform& T = config.T_imu_lidar;
    T.rotation = T.rotation * exp_so3(kWrongTurn * Eigen::Vector3d(1, -1, 1).normalized());
    T.translation += kWrongShift * Eigen::Vector3d(1, 1, -1).normalized();
    return config;
  }
};

TEST_F(Extrinsics, WrongOnesMoveTowardsTheTruthAndTheTrajectoryWithThem) {
  const SimulatedDrive drive = simulate_drive("rooms", kDuration, 1);
  const RigidTransform truth = simulated_robot().T_imu_lidar;
  LioConfig config = wrong_robot();
  const auto ate = [&](const std::vector<LioResult>& results) {
    return evaluate_trajectory(drive.truth, trajectory_of(results), Alignment::kSe3).translation.rmse;
  };
  const double without = ate(run_odometry(drive, config));
  config.estimate_extrinsics = true;
  const std::vector<LioResult> results = run_odometry(drive, config);
  ASSERT_EQ(results.size(), drive.scans.size());
  const RigidTransform& found = results.back().state.T_imu_lidar;
  EXPECT_LT(turn_between(found, truth), kTurnLeft);
  EXPECT_LT(shift_between(found, truth), kWrongShift);
  EXPECT_LT(ate(results), kErrorLeft * without);
}

TEST_F(Extrinsics, AStandstillTellsNothingOfThem) {
  constexpr double kStanding = 1.0;  // [s]; the walk begins at 3 s
  LioConfig config = wrong_robot();
  config.estimate_extrinsics = true;
  const std::vector<LioResult> results = run_odometry(simulate_drive("rooms", kStanding, 1), config);
  ASSERT_EQ(results.size(), 10U);
  const LioResult& last = results.back();
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(std::sqrt(last.covariance(kExtrinsicRotation + axis, kExtrinsicRotation + axis)),
              0.99 * config.extrinsic_rotation_sigma);
    EXPECT_GT(std::sqrt(last.covariance(kExtrinsicTranslation + axis, kExtrinsicTranslation + axis)),
              0.99 * config.extrinsic_translation_sigma);
  }
  EXPECT_LT(turn_between(last.state.T_imu_lidar, config.T_imu_lidar), 0.1 * kWrongTurn);
  EXPECT_LT(shift_between(last.state.T_imu_lidar, config.T_imu_lidar), 0.1 * kWrongShift);
}

TEST_F(Extrinsics, StayAsTheyWereGivenWhenNotEstimated) {
  const LioConfig config = wrong_robot();
  const std::vector<LioResult> results = run_odometry(simulate_drive("rooms", 5.0, 1), config);
  const LioResult& last = results.back();
  EXPECT_EQ(turn_between(last.state.T_imu_lidar, config.T_imu_lidar), 0.0);
  EXPECT_EQ(shift_between(last.state.T_imu_lidar, config.T_imu_lidar), 0.0);
  EXPECT_EQ((last.covariance.bottomRows<6>().norm()), 0.0);
}

}  // namespace
}  // namespace allan_lio
