// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kLength = 20.0, kWidth = 15.0, kHeight = 2.8;  // [m]
constexpr double kWall = 0.12, kDoorWidth = 1.2, kDoorHeight = 2.1;
constexpr double kImuHeight = 1.2;

/// An inner wall along x (or y) from `from` to `to` at the other coordinate `at`, with doors centred at `doors`.
void add_wall(TriangleMesh& mesh, bool along_x, double from, double to, double at, const std::vector<double>& doors) {
  const auto block = [&](double begin, double end, double low) {
    if (along_x)
      mesh.add_box({begin, at - 0.5 * kWall, low}, {end, at + 0.5 * kWall, kHeight});
    else
      mesh.add_box({at - 0.5 * kWall, begin, low}, {at + 0.5 * kWall, end, kHeight});
  };
  for (const double door : doors) {
    block(from, door - 0.5 * kDoorWidth, 0.0);
    from = door + 0.5 * kDoorWidth;
    block(door - 0.5 * kDoorWidth, from, kDoorHeight);
  }
  block(from, to, 0.0);
}

void add_walls(TriangleMesh& mesh) {
  mesh.add_box({0, 0, 0}, {kLength, kWidth, kHeight});  // the shell, seen from inside
  add_wall(mesh, true, 0.0, kLength, 6.4, {4.0, 10.0, 17.0});
  add_wall(mesh, true, 0.0, kLength, 8.6, {3.0, 11.0, 16.5});
  add_wall(mesh, false, 0.0, 6.4, 7.0, {2.0});
  add_wall(mesh, false, 0.0, 6.4, 13.2, {});
  add_wall(mesh, false, 8.6, kWidth, 8.2, {});
  add_wall(mesh, false, 8.6, kWidth, 13.8, {12.5});
}

void add_furniture(TriangleMesh& mesh) {
  mesh.add_table({4.1, 3.5}, {1.6, 0.8}, 0.75, 0.12);
  mesh.add_table({10.0, 3.6}, {1.4, 0.8}, 0.75, -0.3);
  mesh.add_table({16.7, 3.3}, {1.5, 0.8}, 0.75, 0.5);
  mesh.add_table({17.1, 12.3}, {1.2, 0.8}, 0.75, 0.2);
  mesh.add_table({11.4, 11.2}, {1.2, 0.7}, 0.75, -0.1);
  mesh.add_table({3.9, 12.0}, {1.8, 0.9}, 0.75, 0.35);

  mesh.add_box({6.15, 4.3, 0}, {6.9, 6.0, 1.9});  // cupboards
  mesh.add_box({12.3, 0.3, 0}, {13.1, 1.6, 1.8});
  mesh.add_box({18.9, 5.3, 0}, {19.9, 6.2, 1.5});
  mesh.add_box({19.2, 13.6, 0}, {19.95, 14.9, 2.0}, 0.1);
  mesh.add_box({8.4, 14.1, 0}, {9.2, 14.9, 1.6});
  mesh.add_box({0.2, 14.2, 0}, {1.6, 14.9, 1.1}, -0.05);
  mesh.add_box({7.6, 0.3, 0}, {8.7, 0.9, 0.9});  // crates
  mesh.add_box({13.5, 0.4, 0}, {14.1, 1.1, 1.3}, 0.4);
  mesh.add_box({0.15, 5.5, 0}, {1.1, 6.2, 1.45}, 0.15);
  mesh.add_box({18.8, 6.75, 0}, {19.6, 7.4, 1.25}, 0.2);  // in the corridor
  mesh.add_box({0.3, 7.9, 0}, {1.0, 8.4, 1.6});

  mesh.add_pillar({0.7, 0.8}, 0.2, 0.0, kHeight);
  mesh.add_pillar({8.2, 5.4}, 0.22, 0.0, kHeight);
  mesh.add_pillar({19.1, 1.0}, 0.25, 0.0, kHeight);
  mesh.add_pillar({14.6, 14.2}, 0.22, 0.0, kHeight);
  mesh.add_pillar({12.9, 9.4}, 0.2, 0.0, kHeight);
  mesh.add_pillar({6.9, 9.5}, 0.25, 0.0, kHeight);

  mesh.add_panel({5.3, 0.75, 0}, 1.4, 1.9, -1.35, 0.35);  // boards that lean against the walls
  mesh.add_panel({12.4, 5.9, 0}, 1.0, 1.8, 1.2, 0.25);
  mesh.add_panel({14.0, 5.2, 0}, 1.2, 1.8, 2.6, 0.35);
  mesh.add_panel({19.3, 10.2, 0}, 1.6, 1.9, 0.2, 0.3);
  mesh.add_panel({6.9, 13.9, 0}, 1.3, 1.8, 0.9, 0.3);
  mesh.add_panel({9.1, 9.4, 0}, 1.0, 1.6, -2.2, 0.2);

  mesh.add_box({0, 3.2, 2.35}, {7, 3.7, kHeight});  // ducts under the ceiling
  mesh.add_box({9.6, 0, 2.4}, {10.1, 6.4, kHeight});
  mesh.add_box({13.2, 2.4, 2.3}, {20, 2.9, kHeight});
  mesh.add_box({16.9, 8.6, 2.35}, {17.4, 15, kHeight});
  mesh.add_box({8.2, 11.9, 2.4}, {13.8, 12.4, kHeight});
  mesh.add_box({4.6, 8.6, 2.3}, {5.0, 15, kHeight});
  for (const double x : {2.2, 7.8, 13.1, 18.2}) mesh.add_box({x, 6.4, 2.4}, {x + 0.35, 8.6, kHeight});

  // Hanging lamps: a ceiling at 2.8 m alone is hardly seen by a LiDAR that looks 15 degrees up.
  for (const double x : {1.7, 4.9, 8.7, 11.4, 15.1, 18.3})
    for (const double y : {1.0, 5.1, 10.1, 13.7}) mesh.add_box({x - 0.8, y - 0.4, 2.1}, {x + 0.8, y + 0.4, 2.18});
}

}  // namespace

Scene make_rooms() {
  Scene scene;
  add_walls(scene.mesh);
  add_furniture(scene.mesh);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.3019, Vector3d::UnitZ());
  scene.T_world_drawing.translation = Vector3d(-3.713, 2.439, -0.367);
  scene.record_centre = Vector3d(10.0, 7.5, 1.4);
  const double way[][2] = {
      {2.37, 1.52}, {5.2, 1.95}, {7.0, 2.0},  {8.9, 2.1},   {11.4, 2.5},  {11.7, 4.4},  {10.1, 5.3},  {10.0, 7.4},
      {15.5, 7.6},  {16.9, 7.2}, {17.0, 5.2}, {18.5, 3.4},  {17.3, 1.5},  {14.9, 2.2},  {15.2, 4.7},  {16.9, 5.3},
      {17.0, 7.1},  {16.5, 7.9}, {16.5, 9.9}, {18.5, 11.6}, {17.6, 13.7}, {15.5, 12.8}, {13.8, 12.5}, {12.1, 12.6},
      {9.9, 13.2},  {9.6, 10.7}, {10.9, 9.9}, {11.0, 7.6},  {7.0, 7.4},   {3.4, 7.5},   {3.0, 8.4},   {3.1, 10.2},
      {6.2, 11.0},  {6.3, 13.4}, {2.2, 13.4}, {1.5, 10.8},  {2.9, 9.9},   {3.0, 7.9},   {3.9, 7.1},   {4.0, 5.2},
      {2.0, 4.7},   {1.6, 2.8},  {3.1, 1.7},  {5.3, 1.9},   {7.0, 2.0},   {8.8, 2.15},  {11.5, 2.7},  {11.4, 4.6},
      {10.0, 5.4},  {10.2, 7.2}, {15.1, 7.3}, {16.8, 7.0},  {16.9, 5.3},  {15.1, 4.5},  {15.0, 2.3},  {17.2, 1.6},
      {18.4, 3.5},  {17.1, 5.2}, {16.9, 7.2}, {15.0, 7.8},  {9.9, 7.5},   {4.6, 7.6},   {4.0, 6.9},   {4.0, 5.1},
      {2.2, 4.5},   {1.7, 2.7},  {2.6, 1.6}};
  for (const auto& p : way) scene.plan.waypoints.push_back({{p[0], p[1], kImuHeight}, 0.97});
  scene.plan.knot_interval = 0.35;
  return scene;
}

}  // namespace allan_lio
