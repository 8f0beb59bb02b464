// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {

Scene make_field() {
  Scene scene;
  add_ground(scene.mesh, {-400, -400}, {560, 400});
  // A pole of 0.3 m is a point or two wide at 60 m.
  const double poles[][2] = {{38, 47},  {-60, 66},  {-34, -63}, {74, -71},  {121, 58}, {152, -52}, {214, 9},
                             {96, 113}, {181, 101}, {203, -96}, {31, -126}, {-95, 4},  {268, 61},  {83, 8}};
  for (const auto& p : poles) scene.mesh.add_pillar({p[0], p[1]}, 0.15, 0.0, 6.0);
  scene.record_centre = Eigen::Vector3d(40.0, 0.0, 1.6);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.3571, Eigen::Vector3d::UnitZ());
  scene.T_world_drawing.translation = Eigen::Vector3d(3.917, -2.331, 0.219);

  constexpr double kCrawl = 2.5, kDrive = 5.0;  // [m/s]
  const double way[][3] = {{0, 0, kCrawl},     {8, -3, kCrawl},    {25, -18, kDrive}, {60, -31, kDrive},
                           {100, -30, kDrive}, {135, -14, kDrive}, {158, 11, kDrive}, {157, 36, kDrive},
                           {138, 50, kCrawl},  {105, 40, kDrive},  {72, 30, kDrive},  {50, 14, kDrive},
                           {52, -8, kCrawl},   {70, -16, kDrive},  {100, -5, kDrive}, {112, 15, kCrawl},
                           {100, 29, kCrawl},  {60, 38, kDrive},   {24, 30, kDrive},  {4, 14, kDrive},
                           {-3, 4, kCrawl}};
  for (const auto& p : way) scene.plan.waypoints.push_back({{p[0], p[1], kSceneImuHeight}, p[2]});
  scene.plan.acceleration = 1.2;
  scene.plan.knot_interval = 0.5;
  apply_motion_profile("driving", 1, scene.plan);
  return scene;
}

}  // namespace allan_lio
