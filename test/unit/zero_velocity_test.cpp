// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/zero_velocity.h"

#include <gtest/gtest.h>

#include "scene_points.h"

namespace allan_lio {
namespace {

const ResidualOptions kOptions{4e-4, 3.0, 2.0, false};

std::vector<Eigen::Vector3f> seen_from(const Eigen::Vector3d& position) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : room_points(2000, 0.02, 5)) points.push_back((p - position).cast<float>());
  return points;
}

TEST(ZeroVelocity, AScanFromTheSamePlaceAgreesAndOneFromHalfAMetreOnDoesNot) {
  const auto map = make_plane_voxel_map({0.5, 0.02, 50.0, 100.0});
  map->insert(room_points(60000, 0.02, 1), Eigen::Vector3d::Zero());
  TaskPool pool(1);
  PointToPlane residuals(pool);
  EXPECT_FALSE(contradicts_standstill(seen_from({0, 0, 0}), LioState{}, *map, kOptions, residuals));
  EXPECT_TRUE(contradicts_standstill(seen_from({0.15, 0, 0}), LioState{}, *map, kOptions, residuals));
}

TEST(ZeroVelocity, AMapWithoutPlanesContradictsNothing) {
  const auto map = make_plane_voxel_map({0.5, 0.02, 50.0, 100.0});
  map->insert(room_points(50, 0.02, 1), Eigen::Vector3d::Zero());
  TaskPool pool(1);
  PointToPlane residuals(pool);
  EXPECT_FALSE(contradicts_standstill(seen_from({0.15, 0, 0}), LioState{}, *map, kOptions, residuals));
}

TEST(ZeroVelocity, TheUpdateIsAKalmanStepThatPullsThePositionAlong) {
  // Velocity known to 10 m/s and position to what 0.1 s of it makes: fully correlated.
  LioState state;
  state.nav.velocity_world = {2.0, 0.0, -1.0};
  LioMatrix p = LioMatrix::Zero();
  for (int i = 0; i < 3; ++i) {
    p(kVelocity + i, kVelocity + i) = 100.0;
    p(kPosition + i, kVelocity + i) = p(kVelocity + i, kPosition + i) = 10.0;
    p(kPosition + i, kPosition + i) = 1.0;
  }
  update_zero_velocity(0.05, state, p);
  const double gain = 100.0 / (100.0 + 0.0025);
  EXPECT_NEAR(state.nav.velocity_world.x(), 2.0 * (1.0 - gain), 1e-12);
  EXPECT_NEAR(state.nav.T_world_imu.translation.x(), -2.0 * 0.1 * gain, 1e-12);
  EXPECT_NEAR(p(kVelocity, kVelocity), 0.0025 * gain, 1e-9);
  EXPECT_NEAR(p(kPosition, kPosition), 0.01 * 0.0025 * gain, 1e-9);
}

}  // namespace
}  // namespace allan_lio
