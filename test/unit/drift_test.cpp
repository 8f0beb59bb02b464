// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/drift.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "allan_lio/lio/iterated_update.h"
#include "allan_lio/lio/point_to_plane.h"

namespace allan_lio {
namespace {

constexpr double kNoise = 0.02;  // [m]
const VoxelMapOptions kOptions{0.5, kNoise, 50.0, 100.0};
constexpr std::uint32_t kOld = 3, kYoung = 20;
const OldPlanes kLookFor{0.6, 5};

/// Even points on the wall x = `at`, y and z within `half` of 0.
std::vector<Eigen::Vector3d> wall(double at, double half, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-half, half);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back({at + noise(random), along(random), along(random)});
  return points;
}

std::vector<Eigen::Vector3d> moved(std::vector<Eigen::Vector3d> points, const Eigen::Vector3d& by) {
  for (Eigen::Vector3d& p : points) p += by;
  return points;
}

PoseMatrix position_covariance(double sigma) {
  PoseMatrix out = 1e-8 * PoseMatrix::Identity();
  out.bottomRightCorner<3, 3>() *= 1e8 * sigma * sigma;
  return out;
}

TEST(OldPlanes, AreThoseOfThePartsThatTheRunHasDriftedOff) {
  const std::vector<PoseMatrix> parts{position_covariance(0.3), position_covariance(0.2), position_covariance(0.01)};
  const OldPlanes found = old_planes(parts, {5, 9, 14}, kDriftedOff);
  EXPECT_EQ(found.last_epoch, 9U);
  EXPECT_NEAR(found.reach, 0.9, 1e-9) << "three sigma of the farthest";
  EXPECT_EQ(old_planes({position_covariance(0.07)}, {5}, kDriftedOff).reach, 0.0);
  EXPECT_NEAR(old_planes({position_covariance(0.07)}, {5}, kMayBeAside).reach, 0.21, 1e-9);
  EXPECT_EQ(old_planes({}, {}, kDriftedOff).reach, 0.0);
}

TEST(OldPlanes, AreFoundBesideAPointWhoseOwnVoxelIsEmpty) {
  const auto map = make_plane_voxel_map(kOptions);
  map->insert(wall(2.25, 3.0, 40000, 1), Eigen::Vector3d::Zero(), kOld);
  const Eigen::Vector3d beside(2.65, 0.2, 0.2), sensor = Eigen::Vector3d::Zero();
  Plane scratch;
  ASSERT_EQ(map->find(beside, scratch), nullptr);
  const Plane* plane = map->find_old(beside, sensor, kLookFor);
  ASSERT_NE(plane, nullptr);
  EXPECT_NEAR(std::abs(plane->distance(beside)), 0.4, 0.01);
  EXPECT_EQ(map->find_old(beside, sensor, {0.3, 5}), nullptr) << "out of reach";
  EXPECT_EQ(map->find_old(beside, {5, 0, 0}, kLookFor), nullptr) << "that is the wall's other side";
  EXPECT_EQ(map->find_old(beside, sensor, {0.6, 2}), nullptr) << "too young";
}

TEST(OldPlanes, ABoxOfThemTellsOfEveryPointInItWhatTheMapTells) {
  const auto map = make_plane_voxel_map(kOptions);
  map->insert(wall(2.25, 3.0, 40000, 1), Eigen::Vector3d::Zero(), kOld);
  map->insert(wall(2.4, 3.0, 40000, 2), {5.0, 0.0, 0.0}, kOld);  // the other side of a thin wall
  map->insert(moved(wall(3.25, 1.0, 20000, 3), {0.0, 2.0, 0.0}), Eigen::Vector3d::Zero(), kYoung);
  std::vector<Eigen::Vector3d> floor = wall(-1.1, 3.0, 40000, 4);
  for (Eigen::Vector3d& p : floor) p = Eigen::Vector3d(p.y() + 2.0, p.z(), p.x());
  map->insert(floor, Eigen::Vector3d::Zero(), kOld);

  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto in = [&](const Eigen::AlignedBox3d& box) -> Eigen::Vector3d {
    return box.min() + Eigen::Vector3d(unit(random), unit(random), unit(random)).cwiseProduct(box.sizes());
  };
  const Eigen::AlignedBox3d all(Eigen::Vector3d(-1.0, -3.5, -2.0), Eigen::Vector3d(4.0, 3.5, 3.5));
  OldPlaneBox box;
  int found = 0, empty = 0, beyond = 0;
  for (int i = 0; i < 300; ++i) {
    const double reach = 0.1 + 0.7 * unit(random);
    Eigen::AlignedBox3d points(in(all));
    points.extend(points.min() + Eigen::Vector3d(unit(random), unit(random), unit(random)));
    const Eigen::Vector3d aside = Eigen::Vector3d::Constant(std::min(reach, kOptions.voxel_size));
    ASSERT_TRUE(map->gather_old({points.min() - aside, points.max() + aside}, kLookFor.last_epoch, box));
    empty += box.empty() ? 1 : 0;
    for (int k = 0; k < 30; ++k) {
      const Eigen::Vector3d point = k == 0 ? points.min() : k == 1 ? points.max() : in(points), sensor = in(all);
      const Plane* expected = map->find_old(point, sensor, {reach, kLookFor.last_epoch});
      ASSERT_EQ(box.find(point, sensor, reach), expected) << point.transpose();
      found += expected ? 1 : 0;
      beyond += map->find_old(point, sensor, {reach, kYoung}) != expected ? 1 : 0;
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(empty, 20);
  EXPECT_GT(beyond, 30) << "or no young plane was ever in reach";
}

TEST(OldPlanes, OfTheBoxBeforeNothingIsLeft) {
  const Eigen::Vector3d corner = Eigen::Vector3d::Constant(3.0), sensor = Eigen::Vector3d::Zero(), at(2.3, 0.2, 0.2);
  const auto map = make_plane_voxel_map(kOptions), points = make_point_voxel_map(kOptions);
  map->insert(wall(2.25, 3.0, 40000, 1), sensor, kOld);
  points->insert(wall(2.25, 3.0, 4000, 1), sensor, kOld);
  OldPlaneBox box;
  const auto has_any = [&](const VoxelMap& asked, const Eigen::AlignedBox3d& of) {
    EXPECT_TRUE(asked.gather_old(of, kYoung, box));
    EXPECT_EQ(box.empty(), box.find(at, sensor, 0.3) == nullptr);
    return !box.empty();
  };
  EXPECT_TRUE(has_any(*map, {-corner, corner}));
  EXPECT_FALSE(has_any(*points, {-corner, corner})) << "it has no planes";
  EXPECT_TRUE(has_any(*map, {-corner, corner}));
  EXPECT_FALSE(has_any(*map, {-corner, Eigen::Vector3d::Zero()}));
}

TEST(OldPlanes, ABoxThatIsTooLargeOrTooFarAwayIsRefused) {
  const auto map = make_plane_voxel_map(kOptions);
  const Eigen::Vector3d one = Eigen::Vector3d::Ones();
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  OldPlaneBox box;
  EXPECT_TRUE(map->gather_old({-4.0 * one, 4.0 * one}, kOld, box));
  EXPECT_FALSE(map->gather_old({-50.0 * one, 50.0 * one}, kOld, box));
  EXPECT_FALSE(map->gather_old({1e12 * one, 1e12 * one}, kOld, box));
  EXPECT_FALSE(map->gather_old({-infinity * one, infinity * one}, kOld, box));
  EXPECT_FALSE(map->gather_old({nan * one, nan * one}, kOld, box));
  EXPECT_FALSE(map->gather_old({one, -one}, kOld, box)) << "nothing lies in it";
  EXPECT_TRUE(box.empty());
}

TEST(OldPlanes, AreStillFoundWhenTheRunHasGoneFarAndIsBack) {
  const auto map = make_plane_voxel_map(kOptions);
  map->insert(wall(2.25, 3.0, 40000, 1), Eigen::Vector3d::Zero(), kOld);
  const Eigen::Vector3d beside(2.65, 0.2, 0.2), sensor = Eigen::Vector3d::Zero();
  for (std::uint32_t i = 0; i < 200; ++i) {
    const Eigen::Vector3d way(0.0, 6.0 * (i + 1), 0.0);
    const bool goes_on = i < 60;
    map->insert(goes_on ? moved(wall(2.25, 3.0, 2000, 10 + i), way) : std::vector<Eigen::Vector3d>{}, way, kYoung + i);
    ASSERT_NE(map->find_old(beside, sensor, kLookFor), nullptr) << i;
  }
  EXPECT_GT(map->voxels(), 5000U);
}

TEST(OldPlanes, AreStillFoundWhenAFullMapHasMadeRoom) {
  VoxelMapOptions options = kOptions;
  options.max_mb = 1.6;
  const auto map = make_plane_voxel_map(options);
  map->insert(moved(wall(2.25, 11.0, 40000, 1), {0.0, 70.0, 0.0}), {0.0, 70.0, 0.0}, kOld);
  const std::size_t far_away = map->voxels();
  map->insert(wall(2.25, 3.0, 40000, 2), Eigen::Vector3d::Zero(), kOld);
  const std::size_t before = map->voxels();
  for (int i = 0; i < 85; ++i) map->insert({}, Eigen::Vector3d::Zero(), kYoung);  // once around, and a third
  map->insert(moved(wall(2.25, 11.0, 40000, 3), {0.0, 15.0, 0.0}), Eigen::Vector3d::Zero(), kYoung);
  ASSERT_LT(map->voxels(), before + far_away) << "it has not made room";
  for (int i = 0; i < 150; ++i) {
    ASSERT_NE(map->find_old({2.65, 0.2, 0.2}, Eigen::Vector3d::Zero(), kLookFor), nullptr) << i;
    map->insert({}, Eigen::Vector3d::Zero(), kYoung);
  }
}

TEST(OldPlanes, OfWhosePointsTooFewWereThereAtFirstAreFoundOnceTheyArePlanes) {
  const auto map = make_plane_voxel_map(kOptions);
  const std::vector<Eigen::Vector3d> patch = moved(wall(2.25, 0.24, 9, 2), {0.0, 0.25, 0.25});  // into one voxel
  const Eigen::Vector3d beside(2.65, 0.25, 0.25), sensor(0.0, 0.25, 0.25);
  map->insert(moved(wall(2.25, 12.0, 40000, 3), {0.0, 60.0, 0.0}), {0.0, 60.0, 0.0}, kOld);
  ASSERT_GT(map->voxels(), 2000U) << "so that it takes many scans until all are looked through by turns";
  map->insert({patch.begin(), patch.begin() + 7}, sensor, kOld);
  for (std::uint32_t i = 1; i < 4; ++i) map->insert({}, sensor, kOld + i);
  ASSERT_EQ(map->find_old(beside, sensor, kLookFor), nullptr);
  map->insert({patch.begin() + 7, patch.end()}, sensor, kOld + 4);
  EXPECT_NE(map->find_old(beside, sensor, kLookFor), nullptr) << "seven of nine points are of epoch 3";
}

TEST(OldPlanes, ANarrowOneIsKnownOnlyFromWhereItWasSeen) {
  const auto map = make_plane_voxel_map(kOptions);
  const Eigen::Vector3d into_a_voxel(0.0, 0.25, 0.25);
  map->insert(moved(wall(2.25, 0.19, 400, 2), into_a_voxel), {-8.0, 0.0, 0.0}, kOld);
  const Eigen::Vector3d beside(2.4, 0.2, 0.2);
  EXPECT_NE(map->find_old(beside, {-6.0, 2.0, 0.0}, kLookFor), nullptr);
  EXPECT_EQ(map->find_old(beside, {-3.0, 8.0, 0.0}, kLookFor), nullptr) << "56 deg off; a pillar shows another surface";
}

TEST(OldPlanes, ArePreferredToTheYoungOnesOfARunThatCameBackAside) {
  // The wall stands at 2.25 m. The run is 0.3 m off, 1.5 sigma of what it knows of itself, and has begun to make the
  // wall again where it sees it now.
  constexpr double kAside = 0.3;
  const auto map = make_plane_voxel_map(kOptions);
  map->insert(wall(2.25, 3.0, 40000, 1), Eigen::Vector3d::Zero(), kOld);
  map->insert(wall(2.25 + kAside, 3.0, 40000, 3), {kAside, 0.0, 0.0}, kYoung);
  LioState state;
  state.nav.T_world_imu.translation = {kAside, 0.0, 0.0};
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : wall(2.25, 2.0, 500, 4)) points.push_back(p.cast<float>());
  ScanUncertainty uncertainty;
  uncertainty.pose = position_covariance(0.002);
  const std::vector<std::uint32_t> last_epochs{5, 25};
  const ResidualOptions options{kNoise * kNoise, 3.0, 1e9, false};
  TaskPool pool(1);
  PointToPlane residuals(pool);
  const auto shift = [&](double sigma) {
    uncertainty.parts = {position_covariance(sigma), position_covariance(0.002)};
    const NormalEquations sum = residuals.linearize(points, state, uncertainty, *map, options, last_epochs);
    return sum.gradient[3] / sum.information(3, 3);
  };
  EXPECT_NEAR(shift(0.2), -kAside, 0.01);
  EXPECT_NEAR(shift(0.05), 0.0, 0.03) << "who has not drifted is where the nearest wall says";
}

}  // namespace
}  // namespace allan_lio
