// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846, kHalfWidth = 0.5 * kCorridorWidth;

}  // namespace

Scene make_corridor() {
  Scene scene;
  scene.max_range = 60.0;
  add_tube(scene.mesh, 0.0, kCorridorLength, kHalfWidth);
  add_hall(scene.mesh, 0.0, -1.0);
  add_hall(scene.mesh, kCorridorLength, 1.0);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(-0.5537, Eigen::Vector3d::UnitZ());
  scene.T_world_drawing.translation = Eigen::Vector3d(12.917, 7.331, 0.413);
  scene.record_centre = Eigen::Vector3d(30.0, 0.0, 0.5 * kCorridorHeight);
  constexpr double kStroll = 1.0, kWalk = 1.45;  // [m/s]
  const double way[][3] = {
      {-6.13, -1.37, kStroll}, {-3.6, -0.35, kStroll}, {-2.7, 1.2, kStroll},   {-4.3, 1.5, kStroll},
      {-6.4, 0.5, kStroll},    {-5.9, -1.0, kStroll},  {-3.1, -0.5, kStroll},  {-0.6, 0.05, kStroll},
      {30, 0.22, kWalk},       {60, -0.18, kWalk},     {90, 0.2, kWalk},       {120, -0.15, kWalk},
      {150.5, 0.1, kWalk},     {153.0, 0.4, kStroll},  {155.6, 1.2, kStroll},  {156.4, -0.5, kStroll},
      {154.6, -1.6, kStroll},  {151.8, -0.4, kStroll}, {149.0, -0.1, kStroll}, {118, -0.25, kWalk},
      {88, 0.2, kWalk},        {58, -0.15, kWalk},     {28, 0.25, kWalk},      {-0.5, 0.0, kWalk},
      {-3.9, -0.6, kStroll}};
  for (const auto& p : way) scene.plan.waypoints.push_back({{p[0], p[1], kSceneImuHeight}, p[2]});
  scene.plan.knot_interval = 0.35;
  return scene;
}

Scene make_corridor_turn() {
  Scene scene;
  scene.max_range = 20.0;  // less than half a leg, so that neither the hall nor the bend is seen from its middle
  constexpr double kLeg = kCornerLeg, kFar = kLeg + kCorridorWidth;  // [m]
  TriangleMesh leg;  // drawn along x, with its mouth at x = 0 and the bend at x = kLeg
  add_tube(leg, 0.0, kLeg, kHalfWidth);
  add_hall(leg, 0.0, -1.0);
  scene.mesh.append(leg, {});
  RigidTransform second;  // comes up from y = -kHalfWidth - kLeg and ends at the bend too
  second.rotation = Eigen::AngleAxisd(0.5 * kPi, Eigen::Vector3d::UnitZ());
  second.translation << kLeg + kHalfWidth, -kHalfWidth - kLeg, 0.0;
  scene.mesh.append(leg, second);
  add_cross_wall(scene.mesh, kFar, -kHalfWidth, kHalfWidth);
  for (const double z : {0.0, kCorridorHeight})
    scene.mesh.add_quad({kLeg, -kHalfWidth, z}, {kFar, -kHalfWidth, z}, {kFar, kHalfWidth, z}, {kLeg, kHalfWidth, z});
  scene.mesh.add_quad({kLeg, kHalfWidth, 0}, {kFar, kHalfWidth, 0}, {kFar, kHalfWidth, kCorridorHeight},
                      {kLeg, kHalfWidth, kCorridorHeight});

  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.4421, Eigen::Vector3d::UnitZ());
  scene.T_world_drawing.translation = Eigen::Vector3d(-5.173, 3.219, 0.281);
  scene.record_centre = Eigen::Vector3d(30.0, 0.0, 0.5 * kCorridorHeight);
  constexpr double kStroll = 1.0, kWalk = 1.45;  // [m/s]
  const auto go = [&](const Eigen::Vector3d& p, double speed) { scene.plan.waypoints.push_back({p, speed}); };
  const auto hall = [&](const RigidTransform& T, const double(*way)[2], int count) {
    for (int i = 0; i < count; ++i) go(T * Eigen::Vector3d(way[i][0], way[i][1], kSceneImuHeight), kStroll);
  };
  const auto legs = [&](const RigidTransform& T, double from, double to) {
    for (double u = 0.0; u <= 1.0; u += 0.25)
      go(T * Eigen::Vector3d(from + u * (to - from), u == 0.5 ? 0.2 : -0.12, kSceneImuHeight), kWalk);
  };
  const double first_look[][2] = {{-6.13, -1.37}, {-3.6, -0.35}, {-2.7, 1.2},  {-4.3, 1.5},
                                  {-6.4, 0.5},    {-5.9, -1.0},  {-3.1, -0.5}, {-1.0, 0.05}};
  const double round[][2] = {{-2.8, 0.4}, {-5.4, 1.2}, {-6.3, -0.5}, {-4.5, -1.6}, {-2.0, -0.4}};
  const double last_look[][2] = {{-1.0, 0.0}, {-3.9, -0.6}};
  const Eigen::Vector3d bend(kLeg + kHalfWidth - 0.1, 0.1, kSceneImuHeight);
  hall({}, first_look, 8);
  legs({}, 1.0, kLeg - 0.6);
  go(bend, kStroll);
  legs(second, kLeg - 0.6, 1.0);
  hall(second, round, 5);
  legs(second, 1.0, kLeg - 0.6);
  go(bend, kStroll);
  legs({}, kLeg - 0.6, 1.0);
  hall({}, last_look, 2);
  scene.plan.knot_interval = 0.35;
  return scene;
}

}  // namespace allan_lio
