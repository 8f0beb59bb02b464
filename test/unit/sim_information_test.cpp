// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// What one scan without noise tells, from the surfaces' true normals.
struct Look {
  double hit_share = 0.0, nearest = 1e9, farthest = 0.0;  // -, [m], [m]
  double weakest = 0.0;  ///< smallest eigenvalue of the translation's information with the rotation unknown, per hit
};

Look look(const Scene& scene, const RayCaster& caster, const RigidTransform& T_world_lidar) {
  const LidarPattern pattern = make_lidar_pattern("velodyne16");
  constexpr int kColumns = 900;
  Matrix6 information = Matrix6::Zero();
  int hits = 0;
  Look result;
  for (int column = 0; column < kColumns; ++column) {
    const double azimuth = 2.0 * M_PI * column / kColumns;
    for (const LidarBeam& beam : pattern.beams) {
      const Eigen::Vector3d direction =
          T_world_lidar.rotation * Eigen::Vector3d(std::cos(beam.elevation) * std::cos(azimuth),
                                                   std::cos(beam.elevation) * std::sin(azimuth),
                                                   std::sin(beam.elevation));
      const auto hit = caster.cast(T_world_lidar.translation, direction, scene.max_range);
      if (!hit) continue;
      ++hits;
      result.nearest = std::min(result.nearest, hit->range);
      result.farthest = std::max(result.farthest, hit->range);
      Eigen::Matrix<double, 6, 1> row;
      row << (hit->range * direction).cross(hit->normal), hit->normal;
      information += row * row.transpose();
    }
  }
  const Eigen::Matrix3d rotation = information.topLeftCorner<3, 3>() + 1e-9 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d cross = information.bottomLeftCorner<3, 3>();
  const Eigen::Matrix3d translation =
      information.bottomRightCorner<3, 3>() - cross * rotation.inverse() * cross.transpose();
  result.hit_share = static_cast<double>(hits) / (kColumns * static_cast<double>(pattern.beams.size()));
  result.weakest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(translation).eigenvalues()[0] / std::max(hits, 1);
  return result;
}

/// A look every two seconds.
std::vector<Look> looks_along(const std::string& name) {
  const Scene scene = make_scene(name);
  const RayCaster caster(scene.mesh);
  const SimTrajectory trajectory(scene.plan);
  std::vector<Look> looks;
  for (double t = 0.0; t < trajectory.duration(); t += 2.0)
    looks.push_back(look(scene, caster, trajectory.at(t).T_world_imu * default_T_imu_lidar()));
  return looks;
}

/// The part of the way on which a scan tells less than `limit` about its weakest direction.
double share_below(const std::vector<Look>& looks, double limit) {
  const auto count = std::count_if(looks.begin(), looks.end(), [&](const Look& one) { return one.weakest < limit; });
  return static_cast<double>(count) / static_cast<double>(looks.size());
}

struct Expectation {
  const char* name;
  double least_start;  ///< information of the first scan, per hit
  double weak;         ///< below this a scan counts as weak,
  double least, most;  ///< on this share of the way
  double hits;         ///< the least share of beams that come back
  double nearest;      ///< no surface is nearer to the LiDAR [m]
};

class SimInformation : public ::testing::TestWithParam<Expectation> {};

TEST_P(SimInformation, IsWeakWhereItShouldBeAndOnlyThere) {
  const Expectation& expected = GetParam();
  const std::vector<Look> looks = looks_along(expected.name);
  EXPECT_GE(looks.front().weakest, expected.least_start) << "at the standstill";
  const double share = share_below(looks, expected.weak);
  EXPECT_GE(share, expected.least);
  EXPECT_LE(share, expected.most);
  for (const Look& one : looks) {
    EXPECT_GE(one.hit_share, expected.hits);
    EXPECT_GE(one.nearest, expected.nearest);
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SimInformation,
                         ::testing::Values(Expectation{"rooms", 0.005, 0.005, 0.0, 0.0, 1.0, 0.3},
                                           Expectation{"corridor", 0.01, 1e-9, 0.2, 0.4, 0.98, 0.3},
                                           Expectation{"corridor_turn", 0.01, 1e-9, 0.2, 0.45, 0.95, 0.3},
                                           Expectation{"tunnel", 0.05, 0.02, 0.4, 0.8, 0.5, 1.0},
                                           Expectation{"tunnel_smooth", 0.05, 1e-4, 0.3, 0.5, 0.5, 1.0},
                                           Expectation{"field", 0.0, 5e-3, 0.9, 1.0, 0.45, 1.0},
                                           Expectation{"hall", 0.05, 0.02, 0.5, 0.8, 0.4, 1.0},
                                           Expectation{"stairwell", 0.005, 0.02, 0.5, 1.0, 0.99, 0.3},
                                           Expectation{"bridge", 0.05, 0.02, 0.3, 0.6, 0.2, 1.0},
                                           Expectation{"city", 0.1, 0.1, 0.0, 0.0, 0.9, 1.0}),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(SimInformationCoverage, EverySceneIsExpectedOf) { EXPECT_EQ(scene_names().size(), 10u); }

}  // namespace
}  // namespace allan_lio
