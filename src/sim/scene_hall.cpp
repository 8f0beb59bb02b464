// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {

Scene make_hall() {
  constexpr double kLength = 200.0, kWidth = 130.0, kHeight = 12.0;  // [m]
  Scene scene;
  scene.max_range = 30.0;  // less than to the walls from the middle, and to the ceiling at the beams' elevations
  scene.mesh.add_box({0, 0, 0}, {kLength, kWidth, kHeight});
  for (double x = 33.0; x < kLength - 10.0; x += 45.0)
    for (double y = 27.0; y < kWidth - 10.0; y += 38.0) scene.mesh.add_pillar({x, y}, 0.35, 0.0, kHeight);
  // Goods in the corner where the walk begins.
  add_block(scene.mesh, {3.2, 11.6}, {2.4, 1.2, 1.5}, 0.2);
  add_block(scene.mesh, {13.4, 2.4}, {1.2, 2.6, 1.9}, -0.15);
  add_block(scene.mesh, {18.3, 6.2}, {1.6, 1.1, 1.4}, 0.5);
  add_block(scene.mesh, {7.0, 15.7}, {2.8, 1.0, 2.2}, -0.3);
  add_block(scene.mesh, {1.1, 2.0}, {1.5, 1.5, 1.2}, 0.1);
  scene.mesh.add_panel({11.8, 14.6, 0}, 1.8, 2.0, 0.8, 0.35);
  scene.record_centre = Eigen::Vector3d(65.0, 64.5, 1.6);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(-0.3877, Eigen::Vector3d::UnitZ());
  scene.T_world_drawing.translation = Eigen::Vector3d(-4.139, -6.271, 0.333);

  constexpr double kStroll = 1.0, kWalk = 1.45;  // [m/s]
  const double way[][3] = {{5.8, 5.1, kStroll},  {8.6, 6.2, kStroll}, {9.8, 9.3, kStroll},  {7.2, 11.2, kStroll},
                           {5.0, 8.6, kStroll},  {7.4, 6.4, kStroll}, {12.4, 8.0, kStroll}, {20.0, 15.0, kWalk},
                           {36.0, 36.0, kWalk},  {58.0, 45.0, kWalk}, {82.0, 60.0, kWalk},  {106.0, 66.0, kWalk},
                           {118.0, 86.0, kWalk}, {96.0, 92.0, kWalk}, {70.0, 85.0, kWalk},  {56.0, 65.0, kWalk},
                           {44.0, 46.0, kWalk},  {24.0, 27.0, kWalk}, {14.2, 14.0, kWalk},  {9.0, 8.2, kStroll}};
  for (const auto& p : way) scene.plan.waypoints.push_back({{p[0], p[1], kSceneImuHeight}, p[2]});
  scene.plan.knot_interval = 0.4;
  return scene;
}

}  // namespace allan_lio
