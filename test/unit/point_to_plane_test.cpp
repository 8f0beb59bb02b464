// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/point_to_plane.h"

#include <gtest/gtest.h>

#include <random>

#include "allan_lio/lio/iterated_update.h"
#include "allan_lio/math/so3.h"
#include "scene_points.h"

namespace allan_lio {
namespace {

using Pose6 = Eigen::Matrix<double, 6, 6>;

/// One plane everywhere: the residual in its purest form.
class OnePlaneMap : public VoxelMap {
 public:
  explicit OnePlaneMap(const Plane& plane) : plane_(plane) {}
  void insert(const std::vector<Eigen::Vector3d>&, const Eigen::Vector3d&, std::uint32_t) override {}
  const Plane* find(const Eigen::Vector3d&, Plane&) const override { return &plane_; }
  void clear() override {}
  std::size_t voxels() const override { return 1; }
  std::size_t bytes() const override { return sizeof(Plane); }
  std::vector<Eigen::Vector3d> points() const override { return {plane_.center}; }

 private:
  Plane plane_;
};

LioState some_state() {
  LioState state;
  state.nav.T_world_imu = {exp_so3({0.3, -0.2, 1.0}), {1.0, 2.0, 3.0}};
  state.T_imu_lidar = {exp_so3({-0.1, 0.4, 0.2}), {0.1, 0.2, -0.3}};
  return state;
}

Plane some_plane() {
  Plane plane;
  plane.center = {2.0, 1.0, 4.0};
  plane.normal = Eigen::Vector3d(1.0, 2.0, -1.0).normalized();
  plane.thickness = 4e-4;
  return plane;
}

const ResidualOptions kOptions{4e-4, 1e9, 1e9, true};

TEST(PointToPlane, TheGradientIsTheDerivativeOfTheCostInEveryBlock) {
  const OnePlaneMap map(some_plane());
  const LioState state = some_state();
  const std::vector<Eigen::Vector3f> points{{3.0F, -1.0F, 0.5F}};
  TaskPool pool(1);
  PointToPlane residuals(pool);
  const NormalEquations here = residuals.linearize(points, state, ScanUncertainty{}, map, kOptions);
  // cost(x) = z^2 / (2 variance); the LiDAR point stays the same while the extrinsics move.
  const Eigen::Vector3d p_lidar = state.T_imu_lidar.inverse() * points[0].cast<double>();
  const double variance = 4e-4;
  const auto cost = [&](const LioState& x) {
    const double z = some_plane().distance(x.nav.T_world_imu * (x.T_imu_lidar * p_lidar));
    return 0.5 * z * z / variance;
  };
  constexpr double kStep = 1e-6;
  const char* blocks[4] = {"rotation", "translation", "extrinsic rotation", "extrinsic translation"};
  for (int i = 0; i < 12; ++i) {
    LioVector d = LioVector::Zero();
    d[i < 6 ? i : kExtrinsicRotation + i - 6] = kStep;
    const double slope = (cost(lio_plus(state, d)) - cost(lio_plus(state, -d))) / (2 * kStep);
    EXPECT_NEAR(-here.gradient[i], slope, 1e-5 * here.gradient.norm()) << blocks[i / 3];
  }
  // A single residual: information = g g^T / (z^2 / variance).
  const double z2 = here.squared_distance / variance;
  EXPECT_LT((here.information - here.gradient * here.gradient.transpose() / z2).norm(), 1e-9 * here.information.norm());
}

TEST(PointToPlane, PointsOnOnePlaneTellNoMoreThanThePlaneKnows) {
  Plane plane = some_plane();
  plane.center_variance = 1e-4;
  plane.group = 3;
  const OnePlaneMap map(plane);
  const LioState state = some_state();
  TaskPool pool(1);
  PointToPlane residuals(pool);
  // The same point many times: the distance of the plane is known no better than 1e-4 m^2.
  for (const int count : {1, 100, 10000}) {
    const std::vector<Eigen::Vector3f> points(static_cast<std::size_t>(count), {3.0F, -1.0F, 0.5F});
    const NormalEquations sum = residuals.linearize(points, state, ScanUncertainty{}, map, kOptions);
    const double along_normal = plane.normal.dot(sum.information.block<3, 3>(3, 3) * plane.normal);
    EXPECT_NEAR(1.0 / along_normal, 4e-4 / count + 1e-4, 1e-9);
  }
}

TEST(PointToPlane, TheCouplingNoiseIsTheSpreadThatLeaningNormalsGiveTheInformation) {
  // Many points on one plane whose normal is drawn anew: information * direction over the draws.
  Plane plane = some_plane();
  plane.group = 5;
  plane.lean_1 = 1e-3 * plane.normal.unitOrthogonal();
  plane.lean_2 = 2e-3 * plane.normal.cross(plane.normal.unitOrthogonal());
  const LioState state = some_state();
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 40; ++i) points.push_back({3.0F + 0.01F * static_cast<float>(i), -1.0F, 0.5F});
  ResidualOptions options = kOptions;
  options.estimate_extrinsics = false;
  TaskPool pool(1);
  PointToPlane residuals(pool);
  PoseVector direction = PoseVector::Zero();
  direction.tail<3>() = plane.normal.unitOrthogonal();  // no plane measures along it but by its noise
  const auto product = [&](const OnePlaneMap& map) -> PoseVector {
    const NormalEquations sum = residuals.linearize(points, state, ScanUncertainty{}, map, options);
    return sum.information.topLeftCorner<6, 6>() * direction;
  };
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  PoseMatrix spread = PoseMatrix::Zero();
  constexpr int kDraws = 20000;
  for (int i = 0; i < kDraws; ++i) {
    Plane drawn = plane;
    drawn.normal += normal(random) * plane.lean_1 + normal(random) * plane.lean_2;
    const PoseVector d = product(OnePlaneMap(drawn));
    spread += d * d.transpose() / kDraws;
  }
  const OnePlaneMap map(plane);
  const PoseVector untouched = product(map);
  EXPECT_LT(untouched.norm(), 1e-6 * spread.trace());
  const PoseMatrix told = residuals.coupling_noise(points, state, direction);
  EXPECT_LT((told - spread).norm(), 0.05 * spread.norm());
}

/// Small planes that face y, each in a voxel of its own.
class PatchMap : public VoxelMap {
 public:
  explicit PatchMap(const std::vector<Eigen::Vector3d>& centers) {
    for (const Eigen::Vector3d& center : centers) {
      Plane plane;
      plane.center = center;
      plane.normal = Eigen::Vector3d::UnitY();
      plane.thickness = 4e-4;
      plane.group = static_cast<std::uint32_t>(planes_.size());
      planes_.push_back(plane);
    }
  }
  void insert(const std::vector<Eigen::Vector3d>&, const Eigen::Vector3d&, std::uint32_t) override {}
  const Plane* find(const Eigen::Vector3d& point, Plane&) const override {
    for (const Plane& plane : planes_)
      if ((plane.center - point).norm() < 0.1) return &plane;
    return nullptr;
  }
  void clear() override {}
  std::size_t voxels() const override { return planes_.size(); }
  std::size_t bytes() const override { return planes_.size() * sizeof(Plane); }
  std::vector<Eigen::Vector3d> points() const override { return {}; }

 private:
  std::vector<Plane> planes_;
};

TEST(PointToPlane, ThePatchesOfAPillarAreOneThingThatTellsOfTheHeadingAndManyThatTellOfThePosition) {
  constexpr int kPatches = 6;
  std::vector<Eigen::Vector3d> pillar, posts;
  for (int i = 0; i < kPatches; ++i) {
    pillar.emplace_back(10.2, 0.3, 0.5 * i);
    posts.emplace_back(10.2, 0.3 + 2.0 * i, 0.5);
  }
  const ResidualOptions options{4e-4, 1e9, 1e9, false};
  TaskPool pool(1);
  PointToPlane residuals(pool);
  const auto things = [&](const std::vector<Eigen::Vector3d>& centers, const LioState& state, int direction) {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& center : centers)
      points.push_back((state.nav.T_world_imu.inverse() * center).cast<float>());
    const PatchMap map(centers);
    const NormalEquations sum = residuals.linearize(points, state, ScanUncertainty{}, map, options);
    const double information = sum.information(direction, direction);
    const Localizability all;  // each axis a direction
    return information * information / residuals.squares_along(points, state, all)[direction];
  };
  LioState level, on_its_back;  // about whose z, and whose x, the vertical is
  on_its_back.nav.T_world_imu.rotation = exp_so3({0.0, 0.5 * 3.14159265358979323846, 0.0});
  for (const auto& [state, heading] : {std::make_pair(level, kTheta + 2), std::make_pair(on_its_back, kTheta + 0)}) {
    EXPECT_NEAR(things(pillar, state, heading), 1.0, 1e-6);
    EXPECT_NEAR(things(posts, state, heading), kPatches, 1e-3);
    EXPECT_NEAR(things(pillar, state, kPosition + 1), kPatches, 1e-6);
  }
  EXPECT_GT(things(pillar, level, kTheta + 0), 2.5) << "a lean against the pillar is told by its height";
}

TEST(PointToPlane, AResidualBeyondTheGateDoesNotCount) {
  const OnePlaneMap map(some_plane());
  TaskPool pool(1);
  PointToPlane residuals(pool);
  ResidualOptions options = kOptions;
  options.gate = 3.0;
  const LioState state = some_state();
  const std::vector<Eigen::Vector3f> points{{3.0F, -1.0F, 0.5F}};
  EXPECT_EQ(residuals.linearize(points, state, ScanUncertainty{}, map, options).inliers, 0);
  // The same residual passes when the pose itself is that uncertain.
  EXPECT_EQ(residuals.linearize(points, state, ScanUncertainty{Pose6::Identity() * 25.0}, map, options).inliers, 1);
}

TEST(PointToPlane, TwoThreadsGiveTheSameBitsAsOne) {
  const auto map = make_plane_voxel_map({0.5, 0.02, 50.0, 100.0});
  map->insert(room_points(60000, 0.02, 1), Eigen::Vector3d::Zero());
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : room_points(5000, 0.02, 2)) points.push_back(p.cast<float>());
  LioState state;
  TaskPool one(1), two(2);
  PointToPlane a(one), b(two);
  const ResidualOptions options{4e-4, 3.0, 2.0, false};
  const NormalEquations x = a.linearize(points, state, ScanUncertainty{Pose6::Identity() * 1e-4}, *map, options);
  const NormalEquations y = b.linearize(points, state, ScanUncertainty{Pose6::Identity() * 1e-4}, *map, options);
  EXPECT_GT(x.inliers, 3000);
  EXPECT_EQ(x.inliers, y.inliers);
  EXPECT_EQ(x.information, y.information);
  EXPECT_EQ(x.gradient, y.gradient);
  EXPECT_EQ(x.feigned, y.feigned);
}

TEST(PointToPlane, WhatWasSeenLongAgoMayLieAsideByWhatTheRunHasDriftedSince) {
  constexpr double kAside = 0.2;
  Plane old = some_plane(), recent = old;
  old.epoch = 3, recent.epoch = 8;
  const LioState state = some_state();
  const Eigen::Vector3d point = old.center + kAside * old.normal;
  const std::vector<Eigen::Vector3f> points{(state.nav.T_world_imu.inverse() * point).cast<float>()};
  ResidualOptions options = kOptions;
  options.gate = 3.0;
  ScanUncertainty drifted;
  drifted.parts = {kAside * kAside * Pose6::Identity(), Pose6::Zero()};
  TaskPool pool(1);
  PointToPlane residuals(pool);
  const std::vector<std::uint32_t> last_epochs{5, 9};
  const auto inliers = [&](const Plane& plane, const ScanUncertainty& uncertainty) {
    return residuals.linearize(points, state, uncertainty, OnePlaneMap(plane), options, last_epochs).inliers;
  };
  EXPECT_EQ(inliers(old, ScanUncertainty{}), 0);
  EXPECT_EQ(inliers(old, drifted), 1);
  EXPECT_EQ(inliers(recent, drifted), 0) << "that part of the map has not drifted away";
}

}  // namespace
}  // namespace allan_lio
