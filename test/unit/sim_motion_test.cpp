// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "allan_lio/math/so3.h"
#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/recorded_trajectory.h"
#include "allan_lio/sim/scene.h"
#include "shared_data.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr TimeNs kFirst = 1403715273262142976;

void expect_exact_derivatives(const Motion& motion) {
  constexpr double kStep = 5e-6, kTolerance = 1e-6;  // [s], relative to 1 + the derivative's own size
  for (double t = 0.05; t < motion.duration() - 0.05; t += 0.0713) {
    const MotionState before = motion.at(t - kStep), now = motion.at(t), after = motion.at(t + kStep);
    const auto expect_equal = [&](const Vector3d& difference, const Vector3d& exact, const char* what) {
      ASSERT_LT((difference / (2.0 * kStep) - exact).norm(), kTolerance * (1.0 + exact.norm())) << what << " at " << t;
    };
    expect_equal(after.T_world_imu.translation - before.T_world_imu.translation, now.velocity_world, "velocity");
    expect_equal(after.velocity_world - before.velocity_world, now.acceleration_world, "acceleration");
    expect_equal(log_so3(before.T_world_imu.rotation.conjugate() * after.T_world_imu.rotation), now.rate_imu, "rate");
  }
}

TrajectoryPlan bends() {
  TrajectoryPlan plan;
  plan.waypoints = {{{0.3, -0.2, 1.2}, 1.0}, {{9.1, 1.7, 1.2}, 3.0}, {{12.6, 9.3, 1.9}, 3.0}, {{1.2, 14.1, 1.1}, 2.0}};
  return plan;
}

TEST(MotionProfile, AllOfThemAreExactlyDifferentiable) {
  for (const std::string& name : motion_profile_names()) {
    SCOPED_TRACE(name);
    TrajectoryPlan plan = bends();
    apply_motion_profile(name, 7, plan);
    expect_exact_derivatives(SimTrajectory(plan));
  }
}

TEST(MotionProfile, WalkingIsTheDefaultAndDrivingAndFlyingVibrate) {
  const auto shaking = [](const std::string& name) {
    TrajectoryPlan plan;
    plan.waypoints = {{{0, 0, 1}, 3.0}, {{60, 0, 1}, 3.0}};  // straight, so that only the profile accelerates
    if (!name.empty()) apply_motion_profile(name, 1, plan);
    const SimTrajectory trajectory(plan);
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) sum += trajectory.at(10.0 + 0.005 * i).acceleration_world.squaredNorm();
    return std::sqrt(sum / 1000);
  };
  EXPECT_EQ(shaking("walking"), shaking(""));
  EXPECT_NEAR(shaking("driving"), 0.5, 0.2);
  EXPECT_NEAR(shaking("flying"), 0.85, 0.3);
}

TEST(MotionProfile, TheSeedDrawsThePhasesAndNothingElse) {
  const auto at = [](std::uint64_t seed) {
    TrajectoryPlan plan = bends();
    apply_motion_profile("flying", seed, plan);
    return SimTrajectory(plan).at(6.0).T_world_imu.translation;
  };
  EXPECT_EQ(at(3), at(3));
  EXPECT_GT((at(3) - at(4)).norm(), 1e-6);
  EXPECT_LT((at(3) - at(4)).norm(), 0.02);
}

TEST(MotionProfile, AMultirotorLeansIntoItsAccelerationSoThatNothingPullsSideways) {
  TrajectoryPlan plan = bends();
  plan.gait = {1.0, 0, 0, 0, 0, 0, 0.5};
  const auto sideways = [&](double lean) {
    plan.lean = lean;
    const SimTrajectory trajectory(plan);
    double most = 0.0;
    for (double t = 0.0; t < trajectory.duration(); t += 0.01)
      most = std::max(most, specific_force(trajectory.at(t)).head<2>().norm());
    return most;
  };
  constexpr double kSmallAngle = 0.1;  // a lean is the acceleration by g, not its arc tangent
  EXPECT_GT(sideways(0.0), 1.5);
  EXPECT_LT(sideways(1.0 / kSimGravity), kSmallAngle * sideways(0.0));
}

TEST(MotionProfile, AnUnknownOneIsAnsweredWithTheKnownOnes) {
  TrajectoryPlan plan = bends();
  try {
    apply_motion_profile("swimming", 1, plan);
    FAIL() << "not refused";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("walking, driving, flying"), std::string::npos) << error.what();
  }
}

/// A tumbling motion in closed form, as a recorder would write it.
RigidTransform tumbling(double t) {
  return {exp_so3(Vector3d(0.4 * std::sin(0.9 * t), -1.2, 0.3)) * exp_so3(Vector3d(0, 0, 0.8 * t)) *
              exp_so3(Vector3d(0.5 * std::sin(1.3 * t), 0.3 * std::cos(t), 0)),
          Vector3d(2.0 * std::sin(0.5 * t), 0.6 * t, 0.5 * std::cos(0.7 * t))};
}

Trajectory record_of(const std::function<RigidTransform(double)>& pose, double seconds, double rate) {
  Trajectory record;
  for (int i = 0; i <= static_cast<int>(seconds * rate); ++i)
    record.push_back({kFirst + to_ns(i / rate), pose(i / rate)});
  return record;
}

TEST(RecordedTrajectory, FollowsTheRecordAndItsDerivativesAreExact) {
  const Trajectory record = record_of(tumbling, 30.0, 20.0);
  for (const double standstill : {0.0, 3.0}) {
    const RecordedTrajectory trajectory(record, {}, {standstill, 0.1});
    expect_exact_derivatives(trajectory);
    EXPECT_LT(trajectory.position_misfit(), 1e-4);
    EXPECT_LT(trajectory.rotation_misfit(), 1e-4);
    constexpr double kBetween = 14.7731;  // between two samples [s]
    const MotionState state = trajectory.at(trajectory.record_begin() + kBetween);
    EXPECT_LT((state.T_world_imu.translation - tumbling(kBetween).translation).norm(), 1e-4);
    EXPECT_LT(log_so3(state.T_world_imu.rotation.conjugate() * tumbling(kBetween).rotation).norm(), 1e-4);
  }
}

TEST(RecordedTrajectory, RestsExactlyAndThenRunsUpToTheRecord) {
  const Trajectory record = record_of(tumbling, 10.0, 20.0);
  const RecordedTrajectory trajectory(record, {}, {3.0, 0.1});
  for (double t = 0.0; t <= 3.0; t += 0.01) {
    const MotionState state = trajectory.at(t);
    ASSERT_LT(state.acceleration_world.norm(), 1e-9) << t;
    ASSERT_LT(state.rate_imu.norm(), 1e-9) << t;
  }
  for (double t = 3.0; t < trajectory.record_begin(); t += 0.01)
    ASSERT_LT(trajectory.at(t).acceleration_world.norm(), 3.0) << "the run-up is gentle, at " << t;
  EXPECT_GT(trajectory.at(trajectory.record_begin()).velocity_world.norm(), 0.8);
}

TEST(RecordedTrajectory, ItsClockIsTheRecords) {
  const Trajectory record = record_of(tumbling, 10.0, 20.0);
  const RecordedTrajectory moving(record, {}, {0.0, 0.1}), rested(record, {}, {2.0, 0.1});
  EXPECT_EQ(moving.record_begin(), 0.0);
  EXPECT_NEAR(moving.duration(), 10.0, 1e-9);
  EXPECT_GT(rested.record_begin(), 2.0);
  EXPECT_NEAR(rested.duration(), rested.record_begin() + 10.0, 1e-9);
  for (const RecordedTrajectory* trajectory : {&moving, &rested}) {
    EXPECT_EQ(trajectory->first_stamp(), kFirst);
    const RigidTransform pose = trajectory->at(trajectory->time_of(record[77].stamp)).T_world_imu;
    EXPECT_LT((pose.translation - record[77].pose.translation).norm(), 1e-4);
  }
}

TEST(RecordedTrajectory, AQuaternionThatFlipsItsSignIsTheSameMotion) {
  Trajectory record = record_of(tumbling, 10.0, 20.0), flipped = record;
  for (std::size_t i = 0; i < flipped.size(); i += 3) flipped[i].pose.rotation.coeffs() *= -1.0;
  const RecordedTrajectory a(record, {}), b(flipped, {});
  for (double t = 0.0; t < a.duration(); t += 0.1) EXPECT_LT((a.at(t).rate_imu - b.at(t).rate_imu).norm(), 1e-9);
}

TEST(RecordedTrajectory, RefusesRecordsThatCannotBeFollowed) {
  const Trajectory good = record_of(tumbling, 10.0, 20.0);
  const auto refused = [](const Trajectory& record, const RecordedOptions& options, const std::string& word) {
    try {
      RecordedTrajectory(record, {}, options);
      ADD_FAILURE() << "not refused: " << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused({good.begin(), good.begin() + 3}, {}, "four poses");
  Trajectory gap = good;
  gap.erase(gap.begin() + 50, gap.begin() + 100);
  refused(gap, {}, "2.5");
  refused(good, {-1.0, 0.1}, "standstill");
  refused(good, {3.0, std::numeric_limits<double>::quiet_NaN()}, "knot interval");
}

TEST(RecordedTrajectory, IsPlacedByItsBeginOrAlignedByItsBox) {
  const Trajectory record = record_of(
      [](double t) {
        return RigidTransform{Eigen::Quaterniond::Identity(), {5.0 + 0.3 * std::sin(t), 7.0 - t, 0.2 * std::cos(t)}};
      },
      10.0, 20.0);
  const RigidTransform placed = place_record(record, {1, 2, 3}, 0.5);
  EXPECT_LT((placed * record.front().pose.translation - Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_LT((placed.rotation * Vector3d::UnitX() - Vector3d(std::cos(0.5), std::sin(0.5), 0)).norm(), 1e-12);

  constexpr double kHeading = 0.7;
  const RigidTransform aligned = align_record(record, {10, 20, 1.8}, kHeading);
  const Vector3d ahead(std::cos(kHeading), std::sin(kHeading), 0), left(-ahead.y(), ahead.x(), 0);
  double sideways = 0.0;
  for (const StampedPose& pose : record)
    sideways = std::max(sideways, std::abs(left.dot(aligned * pose.pose.translation - Vector3d(10, 20, 1.8))));
  EXPECT_LT(sideways, 0.33);
  const Vector3d first = aligned * record.front().pose.translation, last = aligned * record.back().pose.translation;
  EXPECT_NEAR(ahead.dot(last - first), 10.0, 0.05) << "ahead, not back";
  EXPECT_LT((aligned.rotation * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-12) << "the vertical stays";
}

TEST(RecordedTrajectory, TheTruthOfEurocIsFittedAndPassesThroughTheTunnel) {
  const std::string data = shared_data("euroc_v1_01");
  if (data.empty()) GTEST_SKIP() << "shared/data/euroc_v1_01 is not here";
  const Trajectory record = read_tum(data + "/truth.tum");
  const Scene scene = make_scene("tunnel_smooth");
  const RecordedTrajectory trajectory(
      record, scene.T_world_drawing * align_record(record, scene.record_centre, scene.record_heading));
  EXPECT_LT(trajectory.position_misfit(), 0.002);
  EXPECT_LT(trajectory.rotation_misfit(), 0.2 * kDegree);
  EXPECT_NEAR(trajectory.duration(), trajectory.record_begin() + 144.7, 0.01);
  for (double t = 0.0; t < trajectory.duration(); t += 0.005) {
    ASSERT_LT(trajectory.at(t).acceleration_world.norm(), 4.0) << "no ringing, at " << t;
    ASSERT_LT(trajectory.at(t).rate_imu.norm(), 1.2) << t;
  }
  EXPECT_FALSE(first_collision(trajectory, RayCaster(scene.mesh)));
}

TEST(FirstCollision, FindsTheWallAndItsTime) {
  TriangleMesh mesh;
  mesh.add_quad({5, -3, -3}, {5, 3, -3}, {5, 3, 3}, {5, -3, 3});
  TrajectoryPlan plan;
  plan.waypoints = {{{0, 0, 0}, 1.0}, {{10, 0, 0}, 1.0}};
  const SimTrajectory through(plan);
  const std::optional<double> time = first_collision(through, RayCaster(mesh));
  ASSERT_TRUE(time);
  EXPECT_NEAR(through.at(*time).T_world_imu.translation.x(), 5.0, 0.11);
  plan.waypoints[1].position.x() = 4.5;
  EXPECT_FALSE(first_collision(SimTrajectory(plan), RayCaster(mesh)));
}

}  // namespace
}  // namespace allan_lio
