// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/trajectory_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kExact = 1e-9;  // [m], [rad]: rounding over paths of a hundred metres
constexpr TimeNs kStep = 100'000'000;
constexpr TimeNs kEpoch = 1'600'000'000'000'000'000;

RigidTransform transform(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation) {
  return {exp_so3(rotation), translation};
}

/// A climbing bend, 1 m a step at 10 Hz.
Trajectory bend(int poses = 101) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) {
    const double angle = 0.02 * i;
    trajectory.push_back(
        {kEpoch + i * kStep, transform({0.1 * std::sin(angle), 0.05, angle},
                                       {50 * std::sin(angle), 50 - 50 * std::cos(angle), 2 * std::sin(3 * angle)})});
  }
  return trajectory;
}

/// 1 m a step along x, 10 Hz, no rotation.
Trajectory straight(int poses) {
  Trajectory trajectory;
  for (int i = 0; i < poses; ++i) trajectory.push_back({kEpoch + i * kStep, transform({0, 0, 0}, {1.0 * i, 0, 0})});
  return trajectory;
}

Trajectory moved(const RigidTransform& T, Trajectory trajectory) {
  for (StampedPose& pose : trajectory) pose.pose = T * pose.pose;
  return trajectory;
}

void expect_no_error(const TrajectoryError& e) {
  EXPECT_LT(e.translation.max, kExact);
  EXPECT_LT(e.rotation.max, kExact);
  EXPECT_LT(e.over_1s.translation_rmse, kExact);
  EXPECT_LT(e.over_10m.translation_rmse, kExact);
  EXPECT_LT(e.over_10m.rotation_rmse, kExact);
  EXPECT_LT(e.end_drift, kExact);
  EXPECT_GT(e.over_1s.pairs, 0u);
  EXPECT_GT(e.over_10m.pairs, 0u);
}

std::string refusal(const Trajectory& reference, const Trajectory& estimate, Alignment alignment) {
  try {
    evaluate_trajectory(reference, estimate, alignment);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(TrajectoryError, EqualTrajectoriesHaveNoErrorInAnyAlignment) {
  for (const Alignment a : {Alignment::kSe3, Alignment::kYaw, Alignment::kStart, Alignment::kNone})
    expect_no_error(evaluate_trajectory(bend(), bend(), a));
}

TEST(TrajectoryError, Se3AndStartTakeOutAnyRigidMotion) {
  const RigidTransform T = transform({1.0, -2.0, 0.5}, {100, -30, 7});
  for (const Alignment a : {Alignment::kSe3, Alignment::kStart}) {
    const TrajectoryError e = evaluate_trajectory(bend(), moved(T, bend()), a);
    expect_no_error(e);
    const RigidTransform left_over = e.T_reference_estimate * T;
    EXPECT_LT(left_over.translation.norm(), 1e-8);
    EXPECT_LT(log_so3(left_over.rotation).norm(), kExact);
  }
}

TEST(TrajectoryError, YawTakesOutHeadingAndTranslationAndNoTilt) {
  const RigidTransform heading = transform({0, 0, 2.5}, {100, -30, 7});
  expect_no_error(evaluate_trajectory(bend(), moved(heading, bend()), Alignment::kYaw));

  const double tilt = 0.1;
  const TrajectoryError e =
      evaluate_trajectory(bend(), moved(heading * transform({tilt, 0, 0}, {0, 0, 0}), bend()), Alignment::kYaw);
  EXPECT_NEAR(e.rotation.mean, tilt, 0.02 * tilt);
  EXPECT_GT(e.translation.max, 1.0);
}

TEST(TrajectoryError, Se3NeverMirrors) {
  Trajectory mirrored = bend();
  for (StampedPose& pose : mirrored) pose.pose.translation.y() *= -1;
  const TrajectoryError e = evaluate_trajectory(bend(), mirrored, Alignment::kSe3);
  EXPECT_GT(e.T_reference_estimate.rotation.toRotationMatrix().determinant(), 0.999);
  EXPECT_GT(e.translation.rmse, 0.1);
}

TEST(TrajectoryError, NoneLeavesAKnownOffsetAsItIs) {
  const TrajectoryError e =
      evaluate_trajectory(bend(), moved(transform({0, 0, 0}, {3, 0, 4}), bend()), Alignment::kNone);
  EXPECT_NEAR(e.translation.rmse, 5.0, kExact);
  EXPECT_NEAR(e.translation.mean, 5.0, kExact);
  EXPECT_NEAR(e.translation.median, 5.0, kExact);
  EXPECT_NEAR(e.translation.max, 5.0, kExact);
  EXPECT_LT(e.rotation.max, kExact);
  EXPECT_LT((e.errors[7].translation - Eigen::Vector3d(3, 0, 4)).norm(), kExact);
  EXPECT_LT(e.end_drift, kExact) << "an offset of the worlds is no drift";
}

TEST(TrajectoryError, StatisticsAreThoseOfTheirNames) {
  Trajectory estimate = straight(4);
  for (int i = 0; i < 4; ++i) estimate[i].pose.translation.y() = i;  // errors 0, 1, 2, 3
  const TrajectoryError e = evaluate_trajectory(straight(4), estimate, Alignment::kNone);
  EXPECT_NEAR(e.translation.rmse, std::sqrt(14.0 / 4.0), kExact);
  EXPECT_NEAR(e.translation.mean, 1.5, kExact);
  EXPECT_NEAR(e.translation.median, 1.5, kExact);
  EXPECT_NEAR(e.translation.max, 3.0, kExact);
  EXPECT_NEAR(e.path_length, 3.0, kExact);
  EXPECT_NEAR(e.duration, 0.3, kExact);
}

TEST(TrajectoryError, ARigidRotationOfTheBodyIsARotationError) {
  Trajectory estimate = bend();
  const double angle = 0.25;
  for (StampedPose& pose : estimate) pose.pose = pose.pose * transform({0, angle, 0}, {0, 0, 0});
  const TrajectoryError e = evaluate_trajectory(bend(), estimate, Alignment::kSe3);
  EXPECT_LT(e.translation.max, kExact);
  EXPECT_NEAR(e.rotation.rmse, angle, kExact);
}

TEST(TrajectoryError, AScaleErrorOfOnePerCentIsOnePerCentEverywhere) {
  Trajectory estimate = straight(101);
  for (StampedPose& pose : estimate) pose.pose.translation *= 1.01;
  const TrajectoryError e = evaluate_trajectory(straight(101), estimate, Alignment::kStart);
  EXPECT_NEAR(e.path_length, 100.0, kExact);
  EXPECT_NEAR(e.translation.max, 1.0, kExact);
  EXPECT_NEAR(e.end_drift, 1.0, kExact);
  EXPECT_NEAR(e.end_drift_percent, 1.0, kExact);
  EXPECT_NEAR(e.over_1s.translation_rmse, 0.1, kExact);
  EXPECT_NEAR(e.over_10m.translation_rmse, 0.1, kExact);
  EXPECT_NEAR(e.over_10m.translation_percent, 1.0, kExact);
  EXPECT_EQ(e.over_1s.pairs, 91u);
  EXPECT_EQ(e.over_10m.pairs, 91u);
}

TEST(TrajectoryError, AHeadingDriftIsARelativeRotationError) {
  const double rate = 0.001;  // [rad a step]
  Trajectory estimate = straight(51);
  for (int i = 0; i < 51; ++i) estimate[i].pose.rotation = exp_so3({0, 0, rate * i});
  const TrajectoryError e = evaluate_trajectory(straight(51), estimate, Alignment::kStart);
  EXPECT_NEAR(e.over_1s.rotation_rmse, 10 * rate, kExact);
  EXPECT_NEAR(e.over_10m.rotation_rmse, 10 * rate, kExact);
  EXPECT_NEAR(e.rotation.max, 50 * rate, kExact);
}

TEST(TrajectoryError, TheReferenceIsInterpolatedBetweenItsPoses) {
  Trajectory reference, estimate;
  for (int i = 0; i <= 10; ++i) reference.push_back({i * kStep, transform({0, 0, 0.1 * i}, {1.0 * i, 0, 0})});
  for (int i = 0; i < 10; ++i)
    estimate.push_back({i * kStep + kStep / 4, transform({0, 0, 0.1 * (i + 0.25)}, {i + 0.25, 0, 0})});
  const TrajectoryError e = evaluate_trajectory(reference, estimate, Alignment::kNone);
  EXPECT_EQ(e.matched, 10u);
  EXPECT_LT(e.translation.max, kExact);
  EXPECT_LT(e.rotation.max, kExact);
}

TEST(TrajectoryError, PosesOutsideTheReferenceOrInItsGapsAreCountedAsUnmatched) {
  Trajectory reference = bend(81);
  reference.erase(reference.begin() + 31, reference.begin() + 39);  // leaves 0.9 s between poses 30 and 39
  reference.erase(reference.begin(), reference.begin() + 5);
  const TrajectoryError e = evaluate_trajectory(reference, bend(101), Alignment::kSe3);
  EXPECT_EQ(e.unmatched, 5u + 8u + 20u);
  EXPECT_EQ(e.matched, 101u - 33u);
  EXPECT_LT(e.translation.max, kExact);
  EXPECT_EQ(evaluate_trajectory(reference, bend(101), Alignment::kSe3, 1.0).unmatched, 5u + 20u);
}

TEST(TrajectoryError, ATrajectoryTooShortForAPairSaysSo) {
  const TrajectoryError e = evaluate_trajectory(straight(5), straight(5), Alignment::kStart);
  EXPECT_EQ(e.over_1s.pairs, 0u);
  EXPECT_EQ(e.over_10m.pairs, 0u);
}

TEST(TrajectoryError, AStandstillHasNoPercentage) {
  Trajectory still = straight(30);
  for (StampedPose& pose : still) pose.pose.translation.setZero();
  const TrajectoryError e = evaluate_trajectory(still, still, Alignment::kStart);
  EXPECT_TRUE(std::isnan(e.end_drift_percent));
  EXPECT_TRUE(std::isnan(e.over_1s.translation_percent));
  EXPECT_EQ(e.over_1s.pairs, 20u);
}

TEST(TrajectoryError, WhatCannotBeComparedIsRefused) {
  Trajectory later = bend();
  for (StampedPose& pose : later) pose.stamp += 3600 * kNsPerSecond;
  EXPECT_NE(refusal(bend(), later, Alignment::kSe3).find("no pose of the estimate can be matched"), std::string::npos);
  EXPECT_NE(refusal({}, later, Alignment::kSe3).find("no pose of the estimate can be matched"), std::string::npos);
  EXPECT_NE(refusal(straight(50), straight(50), Alignment::kSe3).find("lie on a line"), std::string::npos);
  EXPECT_EQ(refusal(straight(50), straight(50), Alignment::kYaw), "");
}

}  // namespace
}  // namespace allan_lio
