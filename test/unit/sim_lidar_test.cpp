// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "allan_lio/sim/lidar_simulator.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1700000000 * kNsPerSecond;
constexpr double kPi = 3.14159265358979323846;
const Eigen::Vector3d kLow(-7.3, -4.1, -1.9), kHigh(9.2, 6.4, 2.7);  // of the box around the LiDAR [m]

TriangleMesh box_scene() {
  TriangleMesh mesh;
  mesh.add_box(kLow, kHigh);
  return mesh;
}

/// From the box's inside along `direction` to its walls [m].
double range_to_box(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double range = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] > 0) range = std::min(range, (kHigh[axis] - origin[axis]) / direction[axis]);
    if (direction[axis] < 0) range = std::min(range, (kLow[axis] - origin[axis]) / direction[axis]);
  }
  return range;
}

TrajectoryPlan fast_curve() {
  TrajectoryPlan plan;
  plan.waypoints = {
      {{-3, -1, 0.2}, 1.0}, {{0, 1, 0.2}, 3.0}, {{3, -1, 0.2}, 3.0}, {{4, 2, 0.2}, 3.0}, {{0, 3, 0.2}, 3.0}};
  plan.acceleration = 4.0;
  plan.standstill_begin = 1.0;
  return plan;
}

LidarPattern noise_free(const std::string& name) {
  LidarPattern pattern = make_lidar_pattern(name);
  pattern.range_noise = 0.0;
  return pattern;
}

bool same_points(const SimSweep& a, const SimSweep& b) {
  if (a.points.size() != b.points.size()) return false;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const SimPoint &p = a.points[i], &q = b.points[i];
    if (p.x != q.x || p.y != q.y || p.z != q.z || p.intensity != q.intensity || p.ring != q.ring || p.time != q.time)
      return false;
  }
  return true;
}

class SimLidar : public ::testing::Test {
 protected:
  SimSweep sweep(const LidarPattern& pattern, int index, std::uint64_t seed = 1, int threads = 2) const {
    return LidarSimulator(pattern, default_T_imu_lidar(), trajectory_, caster_, kStart, seed, threads).sweep(index);
  }

  SimTrajectory trajectory_{fast_curve()};
  RayCaster caster_{box_scene()};
};

TEST_F(SimLidar, ASweepAtRestReturnsTheExactRangesToKnownWalls) {
  const RigidTransform T_world_lidar = trajectory_.at(0.0).T_world_imu * default_T_imu_lidar();
  constexpr double kTolerance = 1e-5;  // single precision of the points, twelve metres away at grazing incidence [m]
  for (const std::string& name : lidar_pattern_names()) {
    const LidarPattern pattern = noise_free(name);
    const SimSweep still = sweep(pattern, 0);
    ASSERT_EQ(still.points.size(), pattern.columns * pattern.beams.size()) << name;
    for (const SimPoint& point : still.points) {
      const Eigen::Vector3d p(point.x, point.y, point.z);
      ASSERT_NEAR(p.norm(), range_to_box(T_world_lidar.translation, T_world_lidar.rotation * p.normalized()),
                  kTolerance)
          << name;
    }
  }
}

TEST_F(SimLidar, PointsSitOnTheWallsWhenMovedByThePoseAtTheirOwnTime) {
  const LidarPattern pattern = noise_free("velodyne16");
  constexpr int kSweep = 25;
  constexpr double kTolerance = 1e-5;  // [m]
  const double begin = kSweep / pattern.rotation_rate;
  ASSERT_GT(trajectory_.at(begin).velocity_world.norm(), 1.0);
  double worst_undistorted = 0.0;
  for (const SimPoint& point : sweep(pattern, kSweep).points) {
    const auto distance_to_wall = [&](double time) {
      const Eigen::Vector3d p =
          trajectory_.at(time).T_world_imu * (default_T_imu_lidar() * Eigen::Vector3d(point.x, point.y, point.z));
      return std::min((p - kLow).cwiseAbs().minCoeff(), (kHigh - p).cwiseAbs().minCoeff());
    };
    ASSERT_LT(distance_to_wall(begin + point.time), kTolerance);
    worst_undistorted = std::max(worst_undistorted, distance_to_wall(begin));
  }
  EXPECT_GT(worst_undistorted, 0.1) << "the motion must be seen in the sweep";
}

TEST_F(SimLidar, ThreadsDoNotChangeASingleBit) {
  const LidarPattern pattern = make_lidar_pattern("velodyne16");
  EXPECT_TRUE(same_points(sweep(pattern, 20, 5, 1), sweep(pattern, 20, 5, 2)));
  EXPECT_FALSE(same_points(sweep(pattern, 20, 5, 1), sweep(pattern, 20, 6, 1)));
}

TEST_F(SimLidar, RangeNoiseLiesAlongTheBeamWithItsSigma) {
  const LidarPattern noisy = make_lidar_pattern("velodyne16");
  double square = 0.0, mean = 0.0;
  const SimSweep with = sweep(noisy, 0), without = sweep(noise_free("velodyne16"), 0);
  ASSERT_EQ(with.points.size(), without.points.size());
  const double n = static_cast<double>(with.points.size());
  for (std::size_t i = 0; i < with.points.size(); ++i) {
    const Eigen::Vector3d p(with.points[i].x, with.points[i].y, with.points[i].z);
    const Eigen::Vector3d q(without.points[i].x, without.points[i].y, without.points[i].z);
    ASSERT_LT(p.cross(q).norm(), 1e-4);
    const double error = p.norm() - q.norm();
    mean += error / n;
    square += error * error / n;
  }
  const double variance = noisy.range_noise * noisy.range_noise;
  EXPECT_NEAR(mean, 0.0, 4.0 * noisy.range_noise / std::sqrt(n));
  EXPECT_NEAR(square, variance, 4.0 * variance * std::sqrt(2.0 / n));
}

TEST_F(SimLidar, PointsComeInFiringOrderWithRingsByElevation) {
  for (const std::string& name : lidar_pattern_names()) {
    const LidarPattern pattern = noise_free(name);
    const SimSweep still = sweep(pattern, 3);
    EXPECT_EQ(still.begin, kStart + 300000000) << name;
    EXPECT_EQ(still.end, kStart + 400000000) << name;
    float last = 0.0f;
    for (std::size_t i = 0; i < still.points.size(); ++i) {
      const SimPoint& point = still.points[i];
      ASSERT_GE(point.time, last) << name;
      last = point.time;
      const LidarBeam& beam = pattern.beams[i % pattern.beams.size()];
      ASSERT_EQ(point.ring, beam.ring) << name;
      ASSERT_NEAR(std::atan2(point.z, std::hypot(point.x, point.y)), beam.elevation, 1e-6) << name;
      const double azimuth = -2.0 * kPi * pattern.rotation_rate * point.time;
      ASSERT_NEAR(std::remainder(std::atan2(point.y, point.x) - azimuth, 2.0 * kPi), 0.0, 1e-6) << name;
    }
    EXPECT_LT(last, 0.1f) << name;
  }
}

TEST_F(SimLidar, BeamsBeyondTheRangeLimitsAreLeftOut) {
  LidarPattern pattern = noise_free("velodyne16");
  pattern.min_range = 3.0;
  pattern.max_range = 6.0;
  const SimSweep still = sweep(pattern, 0);
  EXPECT_GT(still.points.size(), 1000u);
  EXPECT_LT(still.points.size(), pattern.columns * pattern.beams.size());
  for (const SimPoint& point : still.points) {
    const double range = Eigen::Vector3d(point.x, point.y, point.z).norm();
    ASSERT_GE(range, pattern.min_range - 1e-6);
    ASSERT_LE(range, pattern.max_range + 1e-6);
  }
}

TEST_F(SimLidar, Velodyne16Fires28800BeamsFromMinus15To15Degrees) {
  const LidarPattern pattern = make_lidar_pattern("velodyne16");
  EXPECT_EQ(pattern.columns * pattern.beams.size(), 28800u);
  for (const LidarBeam& beam : pattern.beams)
    EXPECT_NEAR(beam.elevation, (-15.0 + 2.0 * beam.ring) * kPi / 180.0, 1e-12);
}

TEST_F(SimLidar, CountsTheSweepsThatAreComplete) {
  const LidarSimulator lidar(make_lidar_pattern("velodyne16"), {}, trajectory_, caster_, kStart, 1, 1);
  EXPECT_EQ(lidar.sweeps_within(0.3), 3);
  EXPECT_EQ(lidar.sweeps_within(0.39), 3);
  EXPECT_EQ(lidar.sweeps_within(0.05), 0);
}

TEST_F(SimLidar, RefusesPatternsThatCannotBe) {
  EXPECT_THROW(make_lidar_pattern("velodyne17"), std::invalid_argument);
  const auto refused = [this](const LidarPattern& pattern, int threads = 1) {
    EXPECT_THROW(LidarSimulator(pattern, {}, trajectory_, caster_, kStart, 1, threads), std::invalid_argument);
  };
  refused(LidarPattern());
  LidarPattern pattern = make_lidar_pattern("velodyne16");
  refused(pattern, 0);
  pattern.max_range = pattern.min_range;
  refused(pattern);
  pattern = make_lidar_pattern("velodyne16");
  pattern.columns *= 2;  // the beams of a column no longer fit into its time
  refused(pattern);
}

}  // namespace
}  // namespace allan_lio
