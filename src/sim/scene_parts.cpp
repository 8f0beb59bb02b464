// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_parts.h"

#include <Eigen/Geometry>
#include <cmath>

#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHallDepth = 8.0, kHallHalfWidth = 3.5;  // [m]
constexpr double kHalfWidth = 0.5 * kCorridorWidth;

}  // namespace

void add_tube(TriangleMesh& mesh, double begin, double end, double half_width) {
  const auto corner = [&](double x, double side, double z) { return Vector3d(x, side * half_width, z); };
  for (const double side : {-1.0, 1.0})
    mesh.add_quad(corner(begin, side, 0), corner(end, side, 0), corner(end, side, kCorridorHeight),
                  corner(begin, side, kCorridorHeight));
  for (const double z : {0.0, kCorridorHeight})
    mesh.add_quad(corner(begin, -1, z), corner(end, -1, z), corner(end, 1, z), corner(begin, 1, z));
}

void add_cross_wall(TriangleMesh& mesh, double x, double from, double to) {
  mesh.add_quad({x, from, 0}, {x, to, 0}, {x, to, kCorridorHeight}, {x, from, kCorridorHeight});
}

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

void add_ground(TriangleMesh& mesh, const Vector2d& low, const Vector2d& high) {
  mesh.add_quad({low.x(), low.y(), 0}, {high.x(), low.y(), 0}, {high.x(), high.y(), 0}, {low.x(), high.y(), 0});
}

void add_car(TriangleMesh& mesh, const Vector2d& centre, double yaw) {
  const Vector3d middle(centre.x(), centre.y(), 0.0);
  const auto box = [&](double back, double front, double half_width, double low, double high) {
    const Vector3d ahead(std::cos(yaw), std::sin(yaw), 0.0);
    const Vector3d place = middle + 0.5 * (back + front) * ahead + Vector3d(0, 0, 0.5 * (low + high));
    const Vector3d half(0.5 * (front - back), half_width, 0.5 * (high - low));
    mesh.add_box(place - half, place + half, yaw);
  };
  box(-2.2, 2.2, 0.88, 0.3, 0.85);
  box(-1.6, 0.9, 0.78, 0.85, 1.45);
}

void add_block(TriangleMesh& mesh, const Vector2d& centre, const Vector3d& size, double yaw) {
  const Vector3d middle(centre.x(), centre.y(), 0.5 * size.z());
  mesh.add_box(middle - 0.5 * size, middle + 0.5 * size, yaw);
}

}  // namespace allan_lio
