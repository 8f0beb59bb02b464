// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "box_drive.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;

class SimLidarEffects : public BoxDrive {
 protected:
  LidarPattern with(const std::function<void(LidarEffects&)>& set) const {
    LidarPattern pattern = noise_free("velodyne16");
    set(pattern.effects);
    return pattern;
  }

  /// Of a wall point seen from the LiDAR at rest.
  double cosine(const SimPoint& point) const {
    const RigidTransform T_world_lidar = trajectory_.at(0.0).T_world_imu * default_T_imu_lidar();
    const Eigen::Vector3d direction = T_world_lidar.rotation * Eigen::Vector3d(point.x, point.y, point.z).normalized();
    const Eigen::Vector3d hit =
        T_world_lidar.translation + range_to_box(T_world_lidar.translation, direction) * direction;
    for (int axis = 0; axis < 3; ++axis)
      if (std::abs(hit[axis] - kBoxLow[axis]) < 1e-6 || std::abs(hit[axis] - kBoxHigh[axis]) < 1e-6)
        return std::abs(direction[axis]);
    return 0.0;
  }
};

TEST_F(SimLidarEffects, GrazingNoiseGrowsWithDivergenceRangeAndIncidence) {
  const LidarPattern grazing = with([](LidarEffects& e) { e.divergence = 4e-3, e.grazing = 0.25; });
  const SimSweep exact = sweep(noise_free("velodyne16"), 0), noisy = sweep(grazing, 0);
  ASSERT_EQ(exact.points.size(), noisy.points.size());
  // The spot's length is the noise's: normalised by it, the noise is standard, steep and flat alike.
  double square[2] = {0.0, 0.0}, count[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const double c = cosine(exact.points[i]), range = range_of(exact.points[i]);
    const double sigma = 0.25 * 4e-3 * range * std::sqrt(1.0 - c * c) / c;
    if (sigma < 1e-4) continue;  // single precision of the points shows below
    const double error = (range_of(noisy.points[i]) - range) / sigma;
    square[c > 0.7] += error * error;
    ++count[c > 0.7];
  }
  for (const int group : {0, 1}) {
    ASSERT_GT(count[group], 3000);
    EXPECT_NEAR(square[group] / count[group], 1.0, 4.0 * std::sqrt(2.0 / count[group])) << group;
  }
}

TEST_F(SimLidarEffects, DropoutsComeWithTheirRate) {
  const double all = static_cast<double>(sweep(noise_free("velodyne16"), 0).points.size());
  const double left = static_cast<double>(sweep(with([](LidarEffects& e) { e.dropout_rate = 0.2; }), 0).points.size());
  EXPECT_NEAR(left / all, 0.8, 4.0 * std::sqrt(0.2 * 0.8 / all));
}

TEST_F(SimLidarEffects, FarAndGrazingReturnsAreLostByTheClosedForm) {
  constexpr double kRange = 12.0;
  double expected = 0.0, variance = 0.0;
  for (const SimPoint& point : sweep(noise_free("velodyne16"), 0).points) {
    const double seen = std::exp(-std::pow(range_of(point) / kRange, 2) / cosine(point));
    expected += seen;
    variance += seen * (1.0 - seen);
  }
  const SimSweep lossy = sweep(with([](LidarEffects& e) { e.dropout_range = kRange; }), 0);
  EXPECT_NEAR(static_cast<double>(lossy.points.size()), expected, 4.0 * std::sqrt(variance));
  EXPECT_GT(std::sqrt(variance), 10.0) << "both outcomes must be common";
}

/// A board two metres ahead of a wall. A beam's off-axis ray is even in a disc of radius R = divergence/2, so that a
/// straight edge splits beams over a width of E|x| = 4R/(3 pi) in all: as many per line as columns fit in there.
TEST(SimMixedPixels, AnEdgeSplitsAsManyBeamsAsItsGeometrySays) {
  constexpr double kDivergence = 0.02, kShare = 0.6, kNear = 4.0, kFar = 6.0;
  TriangleMesh mesh;
  mesh.add_quad({kFar, -50, -50}, {kFar, 50, -50}, {kFar, 50, 50}, {kFar, -50, 50});
  mesh.add_quad({kNear, -1, -50}, {kNear, 1, -50}, {kNear, 1, 50}, {kNear, -1, 50});
  const RayCaster caster(mesh);
  TrajectoryPlan plan;
  plan.waypoints = {{{0, 0, 0}, 1.0}, {{1, 0, 0}, 1.0}};
  plan.standstill_begin = 100.0;
  const SimTrajectory rest(plan);
  LidarPattern pattern = noise_free("velodyne16");
  pattern.beams = {{0.0, 0.0, 0}};
  pattern.columns = 3600;
  pattern.effects.divergence = kDivergence;
  pattern.effects.mixed_pixels = kShare;
  const LidarSimulator lidar(pattern, {}, rest, caster, kBoxStart, 1, 2);
  constexpr int kSweeps = 400;
  double between = 0.0, mean = 0.0;
  for (int i = 0; i < kSweeps; ++i) {
    for (const SimPoint& point : lidar.sweep(i).points) {
      const bool mixed = point.x > kNear + 1e-3 && point.x < kFar - 1e-3 && std::abs(point.y) < 3.0;
      between += mixed;
      if (mixed) mean += point.x;
    }
  }
  const double width = 4.0 * (0.5 * kDivergence) / (3.0 * kPi), spacing = 2.0 * kPi / pattern.columns;
  const double expected = kSweeps * 2 * kShare * width / spacing;  // two edges
  // The columns stand where they stand, so that their sum over the width is only near its integral.
  EXPECT_NEAR(between / expected, 1.0, 4.0 / std::sqrt(expected) + 0.02);
  EXPECT_NEAR(mean / between, 0.5 * (kNear + kFar), 0.05) << "evenly between the two surfaces";
}

TEST_F(SimLidarEffects, FlatWallsAndInnerCornersMixNothing) {
  const LidarPattern mixing = with([](LidarEffects& e) { e.divergence = 3e-3, e.mixed_pixels = 1.0; });
  EXPECT_TRUE(same_points(sweep(mixing, 0), sweep(noise_free("velodyne16"), 0)));
}

TEST_F(SimLidarEffects, IntensityFallsWithTheSquareBeyondItsRange) {
  const LidarPattern fading = with([](LidarEffects& e) { e.intensity_range = 5.0; });
  const SimSweep plain = sweep(noise_free("velodyne16"), 0), faded = sweep(fading, 0);
  ASSERT_EQ(plain.points.size(), faded.points.size());
  for (std::size_t i = 0; i < plain.points.size(); ++i) {
    const double factor = std::min(1.0, 25.0 / std::pow(range_of(plain.points[i]), 2));
    ASSERT_NEAR(faded.points[i].intensity, factor * plain.points[i].intensity, 1e-4);
    ASSERT_NEAR(plain.points[i].intensity, 100.0 * cosine(plain.points[i]), 1e-3);
  }
}

TEST_F(SimLidarEffects, RangesAreMultiplesOfTheQuantum) {
  const LidarPattern coarse = with([](LidarEffects& e) { e.quantization = 0.05; });
  const SimSweep exact = sweep(noise_free("velodyne16"), 0), rounded = sweep(coarse, 0);
  double square = 0.0;
  for (std::size_t i = 0; i < exact.points.size(); ++i) {
    const double range = range_of(rounded.points[i]), error = range - range_of(exact.points[i]);
    ASSERT_NEAR(range / 0.05, std::round(range / 0.05), 1e-4);
    ASSERT_LT(std::abs(error), 0.025 + 1e-5);
    square += error * error;
  }
  EXPECT_NEAR(square / static_cast<double>(exact.points.size()), 0.05 * 0.05 / 12.0, 0.1 * 0.05 * 0.05 / 12.0);
}

TEST_F(SimLidarEffects, AnEffectLeavesTheRangeNoiseAlone) {
  LidarPattern lossy = make_lidar_pattern("velodyne16");
  const SimSweep plain = sweep(lossy, 4);
  lossy.effects.dropout_rate = 0.3;
  std::size_t at = 0;
  for (const SimPoint& point : sweep(lossy, 4).points) {
    while (at < plain.points.size() && (plain.points[at].time != point.time || plain.points[at].ring != point.ring))
      ++at;
    ASSERT_LT(at, plain.points.size());
    ASSERT_EQ(plain.points[at].x, point.x);
    ASSERT_EQ(plain.points[at].intensity, point.intensity);
  }
}

TEST_F(SimLidarEffects, ThreadsDoNotChangeASingleBit) {
  for (const std::string& name : lidar_pattern_names()) {
    LidarPattern pattern = make_lidar_pattern(name);
    pattern.effects = {3e-3, 0.25, 0.5, 0.05, 20.0, 5.0, 2e-3};
    EXPECT_TRUE(same_points(sweep(pattern, 20, 5, 1), sweep(pattern, 20, 5, 2))) << name;
    EXPECT_FALSE(same_points(sweep(pattern, 20, 5, 1), sweep(pattern, 20, 6, 1))) << name;
  }
}

TEST_F(SimLidarEffects, EffectsThatCannotBeAreRefused) {
  const auto refused = [this](const std::function<void(LidarEffects&)>& set) {
    EXPECT_THROW(sweep(with(set), 0), std::invalid_argument);
  };
  refused([](LidarEffects& e) { e.dropout_rate = 1.5; });
  refused([](LidarEffects& e) { e.dropout_range = -1.0; });
  refused([](LidarEffects& e) { e.quantization = std::nan(""); });
  refused([](LidarEffects& e) { e.mixed_pixels = 0.5; });  // without a divergence
  refused([](LidarEffects& e) { e.grazing = 0.25; });
}

}  // namespace
}  // namespace allan_lio
