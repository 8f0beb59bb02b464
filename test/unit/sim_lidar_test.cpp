// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>
#include <vector>

#include "box_drive.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// FNV-1a over words.
struct Hash {
  std::uint64_t value = 14695981039346656037ull;
  void add(std::uint64_t word) {
    for (int i = 0; i < 8; ++i, word >>= 8) value = (value ^ (word & 255)) * 1099511628211ull;
  }
  void add(float number) {
    std::uint32_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    add(std::uint64_t{bits});
  }
};

std::vector<std::string> spinning_lidars() { return {"velodyne16", "velodyne32", "ouster64"}; }
std::vector<std::string> livox_lidars() { return {"livox_avia", "livox_mid360"}; }

class SimLidar : public BoxDrive {};

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
  const double begin = kSweep / pattern.sweep_rate;
  ASSERT_GT(trajectory_.at(begin).velocity_world.norm(), 1.0);
  double worst_undistorted = 0.0;
  for (const SimPoint& point : sweep(pattern, kSweep).points) {
    const auto distance_to_wall = [&](double time) {
      const Eigen::Vector3d p =
          trajectory_.at(time).T_world_imu * (default_T_imu_lidar() * Eigen::Vector3d(point.x, point.y, point.z));
      return std::min((p - kBoxLow).cwiseAbs().minCoeff(), (kBoxHigh - p).cwiseAbs().minCoeff());
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
  for (const std::string& name : spinning_lidars()) {
    const LidarPattern pattern = noise_free(name);
    const SimSweep still = sweep(pattern, 3);
    EXPECT_EQ(still.begin, kBoxStart + 300000000) << name;
    EXPECT_EQ(still.end, kBoxStart + 400000000) << name;
    float last = 0.0f;
    for (std::size_t i = 0; i < still.points.size(); ++i) {
      const SimPoint& point = still.points[i];
      ASSERT_GE(point.time, last) << name;
      last = point.time;
      const LidarBeam& beam = pattern.beams[i % pattern.beams.size()];
      ASSERT_EQ(point.ring, beam.ring) << name;
      ASSERT_NEAR(std::atan2(point.z, std::hypot(point.x, point.y)), beam.elevation, 1e-6) << name;
      const double azimuth = -2.0 * kPi * pattern.sweep_rate * point.time;
      ASSERT_NEAR(std::remainder(std::atan2(point.y, point.x) - azimuth, 2.0 * kPi), 0.0, 1e-6) << name;
    }
    EXPECT_LT(last, 0.1f) << name;
  }
}

/// Hashes taken before LiDARs had effects: what was simulated then must still be.
TEST_F(SimLidar, SweepsWithoutEffectsAreTheSameAsEver) {
  const std::pair<const char*, std::uint64_t> known[] = {
      {"velodyne16", 0xf1b98c260692ad34}, {"velodyne32", 0x56c9f91c9eb26a81}, {"ouster64", 0xfd24cf2d27bb3383}};
  for (const auto& [name, value] : known) {
    Hash hash;
    for (const SimPoint& point : sweep(make_lidar_pattern(name), 21, 5).points) {
      for (const float number : {point.x, point.y, point.z, point.intensity}) hash.add(number);
      hash.add(std::uint64_t{point.ring});
      hash.add(point.time);
    }
    EXPECT_EQ(hash.value, value) << name;
  }
}

TEST_F(SimLidar, LivoxPointsLieWhereTheMotorsTurnTheirBeamAtTheirTime) {
  constexpr double kTolerance = 1e-5;  // [rad]
  for (const std::string& name : livox_lidars()) {
    const LidarPattern pattern = noise_free(name);
    const SimSweep still = sweep(pattern, 3);
    ASSERT_EQ(still.points.size(), pattern.columns * pattern.beams.size()) << name;
    for (std::size_t i = 0; i < still.points.size(); ++i) {
      const SimPoint& point = still.points[i];
      const double time = static_cast<double>(i / pattern.beams.size()) * pattern.column_period();
      const LidarBeam& beam = pattern.beams[i % pattern.beams.size()];
      ASSERT_EQ(point.ring, beam.ring);
      ASSERT_NEAR(point.time, time, 1e-7);
      const Eigen::Vector3d direction = Eigen::Vector3d(point.x, point.y, point.z).normalized();
      ASSERT_LT((direction - beam_direction(pattern, beam, 0.3, time)).norm(), kTolerance) << name;
    }
  }
}

TEST_F(SimLidar, LivoxFieldsOfViewAreTheDataSheets) {
  constexpr double kEdge = 0.3;  // how close ten sweeps come to the field's edge [deg]
  const auto expect_span = [&](const std::string& name, double left, double low, double high) {
    const LidarPattern pattern = make_lidar_pattern(name);
    double widest = 0.0, lowest = 90.0, highest = -90.0;
    for (int column = 0; column < 10 * pattern.columns; ++column) {
      for (const LidarBeam& beam : pattern.beams) {
        const Eigen::Vector3d d = beam_direction(pattern, beam, 0.0, column * pattern.column_period());
        ASSERT_NEAR(d.norm(), 1.0, 1e-12);
        const double elevation = std::asin(d.z()) * 180.0 / kPi;
        widest = std::max(widest, std::abs(std::atan2(d.y(), d.x())) * 180.0 / kPi);
        lowest = std::min(lowest, elevation);
        highest = std::max(highest, elevation);
      }
    }
    EXPECT_NEAR(widest, left, kEdge) << name;
    EXPECT_NEAR(lowest, low, kEdge) << name;
    EXPECT_NEAR(highest, high, kEdge) << name;
  };
  expect_span("livox_avia", 35.2, -38.6, 38.6);
  expect_span("livox_mid360", 180.0, -7.0, 52.0);
}

TEST_F(SimLidar, LivoxSweepsDoNotRepeatAndFillTheField) {
  // Cells of half a degree that were seen; the field holds some 17000 of them (Avia) and 85000 (Mid-360).
  const auto cells_after = [](const LidarPattern& pattern, int sweeps) {
    std::set<std::pair<long, long>> cells;
    for (int column = 0; column < sweeps * pattern.columns; ++column)
      for (const LidarBeam& beam : pattern.beams) {
        const Eigen::Vector3d d = beam_direction(pattern, beam, 0.0, column * pattern.column_period());
        cells.insert(
            {std::lround(std::atan2(d.y(), d.x()) * 360.0 / kPi), std::lround(std::asin(d.z()) * 360.0 / kPi)});
      }
    return static_cast<double>(cells.size());
  };
  for (const std::string& name : livox_lidars()) {
    const LidarPattern pattern = make_lidar_pattern(name);
    EXPECT_GT(cells_after(pattern, 5), 1.5 * cells_after(pattern, 1)) << name;
    EXPECT_FALSE(same_points(sweep(noise_free(name), 3), sweep(noise_free(name), 4))) << name;
  }
  EXPECT_EQ(cells_after(make_lidar_pattern("velodyne16"), 5), cells_after(make_lidar_pattern("velodyne16"), 1));
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
  const LidarSimulator lidar(make_lidar_pattern("velodyne16"), {}, trajectory_, caster_, kBoxStart, 1, 1);
  EXPECT_EQ(lidar.sweeps_within(0.3), 3);
  EXPECT_EQ(lidar.sweeps_within(0.39), 3);
  EXPECT_EQ(lidar.sweeps_within(0.05), 0);
}

TEST_F(SimLidar, RefusesPatternsThatCannotBe) {
  EXPECT_THROW(make_lidar_pattern("velodyne17"), std::invalid_argument);
  const auto refused = [this](const LidarPattern& pattern, int threads = 1) {
    EXPECT_THROW(LidarSimulator(pattern, {}, trajectory_, caster_, kBoxStart, 1, threads), std::invalid_argument);
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
