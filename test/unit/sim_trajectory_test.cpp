// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "allan_lio/imu/propagate.h"
#include "allan_lio/math/so3.h"
#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/scene.h"
#include "allan_lio/sim/trajectory.h"

namespace allan_lio {
namespace {

TrajectoryPlan zigzag() {
  TrajectoryPlan plan;
  plan.waypoints = {{{0.3, -0.2, 1.2}, 1.0},
                    {{5.1, 1.7, 1.2}, 1.0},
                    {{5.6, 7.3, 1.3}, 1.3},
                    {{-1.2, 8.1, 1.1}, 0.8},
                    {{-2.0, 3.0, 1.2}, 1.2}};
  return plan;
}

/// The noise-free IMU integrated from the truth at `begin` for `seconds`, and compared with the truth there [m].
double drift_after(const SimTrajectory& trajectory, double begin, double seconds, double rate) {
  const MotionState start = trajectory.at(begin);
  NavState state;
  state.T_world_imu = start.T_world_imu;
  state.velocity_world = start.velocity_world;
  state.gravity_world = Eigen::Vector3d(0, 0, -kSimGravity);
  const auto reading = [&](int k) {
    const MotionState truth = trajectory.at(begin + k / rate);
    return ImuSample{to_ns(k / rate), truth.rate_imu, specific_force(truth)};
  };
  const int steps = static_cast<int>(seconds * rate);
  for (int k = 0; k < steps; ++k) state = propagate_mean(state, mean_interval(state, reading(k), reading(k + 1)), {});
  return (state.T_world_imu.translation - trajectory.at(begin + seconds).T_world_imu.translation).norm();
}

TEST(SimTrajectory, TheNoiseFreeImuIntegratesToTheTruth) {
  const SimTrajectory trajectory(zigzag());
  constexpr double kBegin = 4.0, kSeconds = 10.0, kTolerance = 0.03;  // [s], [s], [m]
  ASSERT_GT(trajectory.duration(), kBegin + kSeconds);
  const double at_200 = drift_after(trajectory, kBegin, kSeconds, 200.0);
  EXPECT_LT(at_200, kTolerance);
  // The mean of two samples is of second order: twice the rate, a quarter of the error.
  const double at_400 = drift_after(trajectory, kBegin, kSeconds, 400.0);
  const double at_800 = drift_after(trajectory, kBegin, kSeconds, 800.0);
  EXPECT_NEAR(at_200 / at_400, 4.0, 0.5);
  EXPECT_NEAR(at_400 / at_800, 4.0, 0.3);
}

TEST(SimTrajectory, RateVelocityAndAccelerationAreTheDerivativesOfThePose) {
  const SimTrajectory trajectory(zigzag());
  constexpr double kStep = 1e-4, kTolerance = 1e-5;  // [s], [SI]
  for (double t = 0.05; t < trajectory.duration(); t += 0.0713) {
    const MotionState before = trajectory.at(t - kStep), now = trajectory.at(t), after = trajectory.at(t + kStep);
    const Eigen::Vector3d velocity = (after.T_world_imu.translation - before.T_world_imu.translation) / (2.0 * kStep);
    const Eigen::Vector3d acceleration = (after.velocity_world - before.velocity_world) / (2.0 * kStep);
    const Eigen::Vector3d rate =
        log_so3(before.T_world_imu.rotation.conjugate() * after.T_world_imu.rotation) / (2.0 * kStep);
    ASSERT_LT((velocity - now.velocity_world).norm(), kTolerance) << "at " << t;
    ASSERT_LT((acceleration - now.acceleration_world).norm(), kTolerance) << "at " << t;
    ASSERT_LT((rate - now.rate_imu).norm(), kTolerance) << "at " << t;
  }
}

TEST(SimTrajectory, AccelerationAndRateHaveNoJumpsAtTheKnots) {
  const TrajectoryPlan plan = zigzag();
  const SimTrajectory trajectory(plan);
  constexpr double kStep = 1e-7, kTolerance = 1e-4;  // [s], [SI]
  for (double knot = plan.knot_interval; knot < trajectory.duration() - 0.1; knot += plan.knot_interval) {
    const MotionState before = trajectory.at(knot - kStep), after = trajectory.at(knot + kStep);
    EXPECT_LT((after.acceleration_world - before.acceleration_world).norm(), kTolerance) << "at " << knot;
    EXPECT_LT((after.rate_imu - before.rate_imu).norm(), kTolerance) << "at " << knot;
  }
}

TEST(SimTrajectory, StandsStillForTheWholeOfTheStandstill) {
  for (const std::string& name : scene_names()) {
    const TrajectoryPlan plan = make_scene(name).plan;
    const SimTrajectory trajectory(plan);
    ASSERT_GE(plan.standstill_begin, 3.0) << name;
    constexpr double kTolerance = 1e-9;
    for (double t = 0.0; t <= plan.standstill_begin; t += 0.01) {
      const MotionState state = trajectory.at(t);
      ASSERT_LT(state.rate_imu.norm(), kTolerance) << name << " at " << t;
      ASSERT_LT((specific_force(state) - Eigen::Vector3d(0, 0, kSimGravity)).norm(), kTolerance) << name << " at " << t;
    }
    EXPECT_GT(trajectory.at(plan.standstill_begin + 3.0).velocity_world.norm(), 0.5) << name;
  }
}

TEST(SimTrajectory, FacesWhereItGoes) {
  const TrajectoryPlan plan = zigzag();
  const SimTrajectory trajectory(plan);
  constexpr double kTolerance = 0.35;  // the gait's sway and the rounding of corners [rad]
  for (double t = 4.5; t < trajectory.duration() - 3.0; t += 0.1) {
    const MotionState state = trajectory.at(t);
    const Eigen::Vector3d ahead = state.T_world_imu.rotation * Eigen::Vector3d::UnitX();
    const double cosine = ahead.head<2>().normalized().dot(state.velocity_world.head<2>().normalized());
    EXPECT_GT(cosine, std::cos(kTolerance)) << "at " << t;
  }
}

TEST(SimTrajectory, SwaysInRollAndHeightWhileItWalks) {
  const SimTrajectory trajectory(zigzag());
  double low = 1e9, high = -1e9, roll = 0.0;
  for (double t = 5.0; t < 8.0; t += 0.01) {  // on the level first leg
    const RigidTransform pose = trajectory.at(t).T_world_imu;
    low = std::min(low, pose.translation.z());
    high = std::max(high, pose.translation.z());
    roll = std::max(roll, std::abs((pose.rotation.conjugate() * Eigen::Vector3d::UnitZ()).y()));
  }
  EXPECT_NEAR(high - low, 2.0 * Gait().vertical, 0.01);
  EXPECT_NEAR(roll, Gait().roll, 0.004);
}

TEST(SimTrajectory, RefusesPlansThatCannotBeWalked) {
  const auto refused = [](const TrajectoryPlan& plan) { EXPECT_THROW(SimTrajectory{plan}, std::invalid_argument); };
  TrajectoryPlan plan = zigzag();
  plan.waypoints.resize(1);
  refused(plan);
  plan = zigzag();
  plan.waypoints[2].speed = 0.0;
  refused(plan);
  plan = zigzag();
  plan.waypoints[2] = plan.waypoints[1];
  refused(plan);
  plan = zigzag();
  plan.knot_interval = std::numeric_limits<double>::quiet_NaN();
  refused(plan);
}

}  // namespace
}  // namespace allan_lio
