// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kHallDepth = 8.0, kHallHalfWidth = 3.5;  // [m]
constexpr double kHalfWidth = 0.5 * kCorridorWidth;
constexpr double kImuHeight = 1.2;

/// A shell along x, open at both ends.
void add_tube(TriangleMesh& mesh, double begin, double end, double half_width) {
  const auto corner = [&](double x, double side, double z) { return Vector3d(x, side * half_width, z); };
  for (const double side : {-1.0, 1.0})
    mesh.add_quad(corner(begin, side, 0), corner(end, side, 0), corner(end, side, kCorridorHeight),
                  corner(begin, side, kCorridorHeight));
  for (const double z : {0.0, kCorridorHeight})
    mesh.add_quad(corner(begin, -1, z), corner(end, -1, z), corner(end, 1, z), corner(begin, 1, z));
}

/// A wall across x from y = `from` to `to`.
void add_cross_wall(TriangleMesh& mesh, double x, double from, double to) {
  mesh.add_quad({x, from, 0}, {x, to, 0}, {x, to, kCorridorHeight}, {x, from, kCorridorHeight});
}

/// The hall beyond the corridor's mouth at x = `mouth`; `out` is the direction away from the corridor, +1 or -1.
void add_hall(TriangleMesh& mesh, double mouth, double out) {
  add_tube(mesh, mouth, mouth + out * kHallDepth, kHallHalfWidth);
  add_cross_wall(mesh, mouth, kHalfWidth, kHallHalfWidth);
  add_cross_wall(mesh, mouth, -kHallHalfWidth, -kHalfWidth);
  add_cross_wall(mesh, mouth + out * kHallDepth, -kHallHalfWidth, kHallHalfWidth);
  const auto at = [&](double depth, double y, double z) { return Vector3d(mouth + out * depth, y, z); };
  const auto block = [&](const Vector3d& a, const Vector3d& b, double yaw) {
    mesh.add_box(a.cwiseMin(b), a.cwiseMax(b), yaw);
  };
  // Wall sections between which doors lie in recesses.
  block(at(1.6, 3.5, 0), at(2.9, 3.2, kCorridorHeight), 0.0);
  block(at(4.1, 3.5, 0), at(6.6, 3.2, kCorridorHeight), 0.0);
  block(at(2.4, -3.5, 0), at(3.6, -3.1, kCorridorHeight), 0.0);
  block(at(7.7, -1.6, 0), at(8.0, -0.4, kCorridorHeight), 0.0);
  block(at(7.6, 0.7, 0), at(8.0, 1.9, kCorridorHeight), 0.0);
  // A counter, boxes, a beam, pillars, a leaning board.
  block(at(6.6, -3.1, 0), at(7.5, -2.0, 1.25), 0.3);
  block(at(0.4, 2.5, 0), at(1.4, 3.3, 0.95), -0.2);
  block(at(0.3, -3.2, 0), at(1.1, -2.3, 1.9), 0.15);
  block(at(3.8, -3.5, 2.25), at(4.2, 3.5, kCorridorHeight), 0.0);
  for (const double depth : {2.0, 5.2}) {
    const Vector3d place = at(depth, depth < 3 ? -2.3 : 2.6, 0);
    mesh.add_pillar(place.head<2>(), 0.2, 0.0, kCorridorHeight);
  }
  mesh.add_panel(at(6.9, 2.6, 0), 1.2, 1.9, 0.6, 0.35);
}

}  // namespace

Scene make_corridor() {
  Scene scene;
  scene.max_range = 60.0;
  add_tube(scene.mesh, 0.0, kCorridorLength, kHalfWidth);
  add_hall(scene.mesh, 0.0, -1.0);
  add_hall(scene.mesh, kCorridorLength, 1.0);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(-0.5537, Vector3d::UnitZ());
  scene.T_world_drawing.translation = Vector3d(12.917, 7.331, 0.413);
  constexpr double kStroll = 1.0, kWalk = 1.45;  // [m/s]
  const double way[][3] = {
      {-6.13, -1.37, kStroll}, {-3.6, -0.35, kStroll}, {-2.7, 1.2, kStroll},   {-4.3, 1.5, kStroll},
      {-6.4, 0.5, kStroll},    {-5.9, -1.0, kStroll},  {-3.1, -0.5, kStroll},  {-0.6, 0.05, kStroll},
      {30, 0.22, kWalk},       {60, -0.18, kWalk},     {90, 0.2, kWalk},       {120, -0.15, kWalk},
      {150.5, 0.1, kWalk},     {153.0, 0.4, kStroll},  {155.6, 1.2, kStroll},  {156.4, -0.5, kStroll},
      {154.6, -1.6, kStroll},  {151.8, -0.4, kStroll}, {149.0, -0.1, kStroll}, {118, -0.25, kWalk},
      {88, 0.2, kWalk},        {58, -0.15, kWalk},     {28, 0.25, kWalk},      {-0.5, 0.0, kWalk},
      {-3.9, -0.6, kStroll}};
  for (const auto& p : way) scene.plan.waypoints.push_back({{p[0], p[1], kImuHeight}, p[2]});
  scene.plan.knot_interval = 0.35;
  return scene;
}

}  // namespace allan_lio
