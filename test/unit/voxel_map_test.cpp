// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/voxel_map.h"

#include <gtest/gtest.h>

#include <random>

#include "scene_points.h"

namespace allan_lio {
namespace {

constexpr double kNoise = 0.02;  // [m]
const VoxelMapOptions kOptions{0.5, kNoise, 50.0, 100.0};

class EveryVoxelMap : public ::testing::TestWithParam<bool> {
 protected:
  std::unique_ptr<VoxelMap> make(const VoxelMapOptions& options) const {
    return GetParam() ? make_plane_voxel_map(options) : make_point_voxel_map(options);
  }
};

TEST_P(EveryVoxelMap, GivesThePlaneOfAWallNearAQuery) {
  auto map = make(kOptions);
  map->insert(room_points(60000, kNoise, 1), Eigen::Vector3d::Zero());
  Plane scratch;
  const Plane* plane = map->find({1.3, 4.07, 0.2}, scratch);
  ASSERT_NE(plane, nullptr);
  constexpr double kNormal = 0.3, kDistance = 0.03;
  EXPECT_GT(std::abs(plane->normal.y()), 1 - kNormal * kNormal);
  EXPECT_NEAR(plane->distance({1.3, 4.07, 0.2}), 0.0, kDistance);
  EXPECT_EQ(map->find({1.3, 0.0, 0.2}, scratch), nullptr) << "nothing stands in the middle of the room";
}

TEST_P(EveryVoxelMap, IsTheSameForTheSameInput) {
  auto a = make(kOptions), b = make(kOptions);
  for (unsigned i = 0; i < 5; ++i) {
    a->insert(room_points(5000, kNoise, i), Eigen::Vector3d::Zero());
    b->insert(room_points(5000, kNoise, i), Eigen::Vector3d::Zero());
  }
  EXPECT_EQ(a->points(), b->points());
}

TEST_P(EveryVoxelMap, StaysBelowItsCapWhateverIsInserted) {
  VoxelMapOptions options = kOptions;
  options.max_mb = 2.0;
  auto map = make(options);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 60; ++i) {
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 2000; ++k)
      points.push_back(Eigen::Vector3d(10.0 * i, 0, 0) +
                       20 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
    map->insert(points, Eigen::Vector3d(10.0 * i, 0, 0));
    ASSERT_LE(map->bytes(), 2.0e6);
  }
  for (const Eigen::Vector3d& p : map->points()) EXPECT_GT(p.x(), 200.0) << "the oldest, farthest part must be gone";
}

TEST_P(EveryVoxelMap, StillFindsPlanesAfterVoxelsWereForgotten) {
  VoxelMapOptions options = kOptions;
  options.max_mb = 1.5;
  auto map = make(options);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d here(15.0 * i, 0, 0);
    std::vector<Eigen::Vector3d> points = room_points(20000, kNoise, 3);
    for (Eigen::Vector3d& p : points) p += here;
    map->insert(points, here);
    Plane scratch;
    int found = 0;
    for (const Eigen::Vector3d& p : points) {
      const Plane* plane = map->find(p, scratch);
      if (!plane) continue;
      ++found;
      ASSERT_LT((plane->center - p).norm(), 3.0);
    }
    ASSERT_GT(found, 10000) << "at room " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, EveryVoxelMap, ::testing::Values(true, false),
                         [](const auto& info) { return info.param ? "planes" : "points"; });

TEST(PlaneFit, CovarianceOfNormalAndOffsetHoldsOverManyFits) {
  // Points on z = 0 over 0.5 x 0.4 m; the fit's normal and height against what it says of them.
  constexpr int kRuns = 500, kPoints = 40;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> u(-0.25, 0.25), v(-0.2, 0.2);
  std::normal_distribution<double> normal(0.0, kNoise);
  const PlaneLimits limits{kNoise * kNoise, 0.1, 0.5, 3.0, 6, 1000};
  double height = 0.0, lean = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    PlaneSums sums;
    for (int i = 0; i < kPoints; ++i) sums.add({u(random), v(random), normal(random)});
    Plane plane;
    ASSERT_TRUE(fit_plane(sums, Eigen::Vector3d::Zero(), limits, plane));
    const Eigen::Vector3d n = plane.normal.z() < 0 ? Eigen::Vector3d(-plane.normal) : plane.normal;
    height += plane.center.z() * plane.center.z() / plane.center_variance;
    const double a = n.dot(Eigen::Vector3d::Zero()) - n.head<2>().norm();
    lean += a * a / (plane.lean_1.squaredNorm() + plane.lean_2.squaredNorm());
  }
  constexpr double kAgreement = 0.25;  // the thickness is floored at the given noise, so the fit errs on the safe side
  EXPECT_NEAR(height / kRuns, 1.0, kAgreement);
  EXPECT_NEAR(lean / kRuns, 1.0, kAgreement);
}

TEST(PlaneFit, RefusesALineABallAndAHandful) {
  const PlaneLimits limits{kNoise * kNoise, 0.05, 0.15, 3.0, 6, 100};
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  PlaneSums line, ball, few;
  for (int i = 0; i < 50; ++i) {
    line.add({0.01 * i, 1e-3 * normal(random), 1e-3 * normal(random)});
    ball.add({normal(random), normal(random), normal(random)});
    if (i < 5) few.add({normal(random), normal(random), 0.0});
  }
  Plane plane;
  EXPECT_FALSE(fit_plane(line, Eigen::Vector3d::Zero(), limits, plane));
  EXPECT_FALSE(fit_plane(ball, Eigen::Vector3d::Zero(), limits, plane));
  EXPECT_FALSE(fit_plane(few, Eigen::Vector3d::Zero(), limits, plane));
}

TEST(PlaneFit, RefusesAStripThatIsNarrowerThanItsNoise) {
  // 1 cm wide with 2 cm of noise: its smallest spread is along its width, which is not its normal.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> width(-0.005, 0.005), length(-0.25, 0.25);
  std::normal_distribution<double> normal(0.0, kNoise);
  PlaneSums strip;
  for (int i = 0; i < 300; ++i) strip.add({width(random), length(random), normal(random)});
  Plane plane;
  EXPECT_FALSE(fit_plane(strip, Eigen::Vector3d::Zero(), {kNoise * kNoise, 0.05, 0.15, 3.0, 6, 100}, plane));
}

TEST(PlaneVoxelMap, TheTwoSidesOfAThinWallAreTwoPlanes) {
  // A wall of 12 cm inside one voxel: seen from one side first, then from the other.
  const auto map = make_plane_voxel_map({0.5, 0.01, 50.0, 100.0});
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> along(0.02, 0.48);
  std::normal_distribution<double> noise(0.0, 0.01);
  const auto face = [&](double x) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 300; ++i) points.push_back({x + noise(random), along(random), along(random)});
    return points;
  };
  map->insert(face(0.19), {-3, 0.2, 0.2}, 7);
  map->insert(face(0.31), {4, 0.2, 0.2}, 9);
  Plane scratch;
  const Plane* near = map->find({0.20, 0.25, 0.25}, scratch);
  const Plane* far = map->find({0.30, 0.25, 0.25}, scratch);
  ASSERT_TRUE(near && far);
  EXPECT_NEAR(near->center.x(), 0.19, 0.003) << "the other side must not draw it over";
  EXPECT_NEAR(far->center.x(), 0.31, 0.003);
  EXPECT_EQ(near->epoch, 7u);
  EXPECT_EQ(far->epoch, 9u);
  EXPECT_NE(near->group, far->group);
}

TEST(PlaneVoxelMap, APointInTheCornerOfTwoPlanesIsNobodys) {
  // A floor and a wall that meet inside of a voxel.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, kNoise);
  std::vector<Eigen::Vector3d> floor, wall;
  for (int i = 0; i < 400; ++i) {
    floor.push_back({0.05 + 0.45 * unit(random), 0.5 * unit(random), 0.05 + normal(random)});
    wall.push_back({0.05 + normal(random), 0.5 * unit(random), 0.2 + 0.3 * unit(random)});
  }
  auto map = make_plane_voxel_map(kOptions);
  map->insert(floor, {2, 0, 2});
  map->insert(wall, {2, 0, 2});
  Plane scratch;
  const Plane* of_floor = map->find({0.4, 0.2, 0.05}, scratch);
  ASSERT_NE(of_floor, nullptr);
  EXPECT_GT(std::abs(of_floor->normal.z()), 0.95);
  const Plane* of_wall = map->find({0.05, 0.2, 0.4}, scratch);
  ASSERT_NE(of_wall, nullptr);
  EXPECT_GT(std::abs(of_wall->normal.x()), 0.95);
  EXPECT_EQ(map->find({0.07, 0.2, 0.07}, scratch), nullptr);
}

/// Points on a tunnel's lining of 3 m about the x axis, evenly spread, with noise along the normal.
std::vector<Eigen::Vector3d> lining(int count, double noise, unsigned seed) {
  constexpr double kRadius = 3.0, kPi = 3.14159265358979323846;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * kPi), along(0.0, 4.0);
  std::normal_distribution<double> normal(0.0, noise);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double a = angle(random), r = kRadius + normal(random);
    points.push_back({along(random), r * std::cos(a), r * std::sin(a)});
  }
  return points;
}

/// Mean distance of points behind the planes that they are compared with, away from the axis [m].
double mean_behind(const VoxelMap& map, const std::vector<Eigen::Vector3d>& points) {
  Plane scratch;
  double sum = 0.0;
  int found = 0;
  for (const Eigen::Vector3d& p : points) {
    const Plane* plane = map.find(p, scratch);
    if (!plane) continue;
    const double inwards = plane->normal.dot(Eigen::Vector3d(0.0, p.y(), p.z())) < 0.0 ? 1.0 : -1.0;
    sum -= inwards * plane->distance(p);
    ++found;
  }
  return sum / found;
}

TEST(PlaneVoxelMap, PointsOnACurvedWallLieOnItsPlanesOnTheAverage) {
  // Over half a metre the lining bulges by 1 cm. A plane made from a larger patch than it is compared with lies
  // millimetres aside, everywhere to the same side: the ceiling of a tunnel seems to rise with every metre of it.
  const auto map = make_plane_voxel_map(kOptions);
  for (unsigned scan = 0; scan < 20; ++scan) map->insert(lining(6000, 0.01, scan), {2, 0, 0});
  constexpr double kMean = 0.0003;  // [m]; 0.0015 with a tenth of the edge around each voxel in its plane
  EXPECT_NEAR(mean_behind(*map, lining(60000, 0.01, 100)), 0.0, kMean);
}

TEST(PlaneVoxelMap, SoTheyDoOnPlanesThatWereJustMade) {
  const auto map = make_plane_voxel_map(kOptions);
  map->insert(lining(6000, 0.003, 1), {2, 0, 0});
  constexpr double kMean = 0.0005;  // [m]
  EXPECT_NEAR(mean_behind(*map, lining(60000, 0.003, 100)), 0.0, kMean);
}

TEST(PlaneVoxelMap, AWallAlongABorderIsSeenWhole) {
  // Half of its noise lies in the one row of voxels and half in the other.
  const auto map = make_plane_voxel_map(kOptions);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> along(-2.0, 2.0);
  std::normal_distribution<double> normal(0.0, kNoise);
  const auto wall = [&](int count) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) points.push_back({1.0 + normal(random), along(random), along(random)});
    return points;
  };
  for (int scan = 0; scan < 20; ++scan) map->insert(wall(3000), {3, 0, 0});
  Plane scratch;
  double sum = 0.0, squares = 0.0;
  int found = 0;
  for (const Eigen::Vector3d& p : wall(20000)) {
    const Plane* plane = map->find(p, scratch);
    if (!plane) continue;
    const double z = plane->distance(p) * (plane->normal.x() > 0.0 ? 1.0 : -1.0);
    sum += z;
    squares += z * z;
    ++found;
  }
  EXPECT_GT(found, 19000);
  EXPECT_NEAR(sum / found, 0.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / found), kNoise, 0.1 * kNoise) << "0.6 of it were the halves apart";
}

TEST(PlaneFit, StructureDoesNotAverageOutLikeNoise) {
  // Planks that stand out by 4 cm: which of them a scan shows decides where the plane seems to lie.
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-0.25, 0.25);
  std::normal_distribution<double> normal(0.0, kNoise);
  PlaneSums sums;
  for (int i = 0; i < 1000; ++i) sums.add({unit(random), unit(random), (i % 2 == 0 ? 0.02 : -0.02) + normal(random)});
  Plane plane;
  ASSERT_TRUE(fit_plane(sums, Eigen::Vector3d::Zero(), {kNoise * kNoise, 0.03, 0.15, 3.0, 12, 100}, plane));
  const double structure = plane.thickness - kNoise * kNoise;
  EXPECT_NEAR(structure, 0.02 * 0.02, 1e-4);
  EXPECT_GT(plane.center_variance, structure / 5.0);
  EXPECT_GT(plane.lean_1.norm(), std::sqrt(structure / 5.0) / 0.25) << "the normal no better than such samples give it";
}

}  // namespace
}  // namespace allan_lio
