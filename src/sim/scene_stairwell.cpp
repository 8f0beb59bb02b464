// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kHalfShaft = 2.0, kNewel = 0.3, kWalkRadius = 1.2;  // [m]
constexpr int kStepsPerTurn = 16, kTurns = 4, kSteps = kStepsPerTurn * kTurns;
constexpr double kRise = 0.18, kStepAngle = 2.0 * kPi / kStepsPerTurn, kFirstAngle = 0.25 * kPi;
constexpr double kTop = kRise * kSteps, kRoom = 2.7;  // height of the upper floor and of the rooms
constexpr double kDoorHalf = 0.6, kDoorHeight = 2.1, kLobby = 5.0, kLobbyHalf = 2.6;

/// On the shaft's square wall, seen from its axis at `angle`.
Vector3d on_wall(double angle, double z) {
  const double c = std::cos(angle), s = std::sin(angle);
  const double reach = kHalfShaft / std::max(std::abs(c), std::abs(s));
  return {reach * c, reach * s, z};
}

Vector3d on_circle(double radius, double angle, double z) {
  return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Wedge-shaped treads and risers; the corners of the square fall between two of them.
void add_stairs(TriangleMesh& mesh) {
  for (int i = 0; i < kSteps; ++i) {
    const double a = kFirstAngle + i * kStepAngle, b = a + kStepAngle, z = (i + 1) * kRise;
    mesh.add_quad(on_circle(kNewel, a, z), on_wall(a, z), on_wall(b, z), on_circle(kNewel, b, z));
    mesh.add_quad(on_circle(kNewel, a, z - kRise), on_wall(a, z - kRise), on_wall(a, z), on_circle(kNewel, a, z));
  }
  for (int i = 0; i < 4; ++i) {  // the upper landing, up to the door at 90 degrees and beyond
    const double a = kFirstAngle + i * kStepAngle, b = a + kStepAngle;
    mesh.add_quad(on_circle(kNewel, a, kTop), on_wall(a, kTop), on_wall(b, kTop), on_circle(kNewel, b, kTop));
  }
  mesh.add_pillar({0, 0}, kNewel, 0.0, kTop + kRoom);
}

/// Shaft wall at x = kHalfShaft of `mesh`'s own frame, with a door at height `door`, if any (NaN: none).
void add_shaft_wall(TriangleMesh& mesh, double door) {
  const auto part = [&](double from, double to, double low, double high) {
    const double x = kHalfShaft;
    mesh.add_quad({x, from, low}, {x, to, low}, {x, to, high}, {x, from, high});
  };
  const double top = kTop + kRoom;
  if (std::isnan(door)) return part(-kHalfShaft, kHalfShaft, 0.0, top);
  part(-kHalfShaft, -kDoorHalf, 0.0, top);
  part(kDoorHalf, kHalfShaft, 0.0, top);
  if (door > 0.0) part(-kDoorHalf, kDoorHalf, 0.0, door);
  part(-kDoorHalf, kDoorHalf, door + kDoorHeight, top);
}

/// A furnished room outside the wall at x = kHalfShaft, its floor at `z`.
void add_lobby(TriangleMesh& mesh, double z) {
  const double near = kHalfShaft, far = kHalfShaft + kLobby, half = kLobbyHalf, top = z + kRoom;
  for (const double side : {-half, half})
    mesh.add_quad({near, side, z}, {far, side, z}, {far, side, top}, {near, side, top});
  for (const double h : {z, top}) mesh.add_quad({near, -half, h}, {far, -half, h}, {far, half, h}, {near, half, h});
  mesh.add_quad({far, -half, z}, {far, half, z}, {far, half, top}, {far, -half, top});
  for (const double side : {-1.0, 1.0})  // beside the shaft, which is narrower
    mesh.add_quad({near, side * kHalfShaft, z}, {near, side * half, z}, {near, side * half, top},
                  {near, side * kHalfShaft, top});
  mesh.add_box({far - 0.6, -2.0, z}, {far, -0.7, z + 1.9}, 0.0);
  mesh.add_box({near + 1.3, half - 0.5, z}, {near + 2.6, half, z + 1.1}, 0.0);
  mesh.add_box({near + 3.1, -half, z}, {near + 4.0, -half + 0.5, z + 0.9}, 0.1);
  mesh.add_box({near, 0.9, z + 2.2}, {far, 1.3, top}, 0.0);  // duct
  mesh.add_box({near + 0.2, -2.1, z + 1.9}, {near + 1.0, -1.7, z + 2.0}, 0.0);
}

}  // namespace

Scene make_stairwell() {
  Scene scene;
  add_stairs(scene.mesh);
  const double doors[] = {0.0, kTop, std::nan(""), std::nan("")};
  RigidTransform side[4];
  for (int i = 0; i < 4; ++i) {
    side[i].rotation = Eigen::AngleAxisd(0.5 * kPi * i, Vector3d::UnitZ());
    TriangleMesh wall;
    add_shaft_wall(wall, doors[i]);
    if (i < 2) add_lobby(wall, doors[i]);
    scene.mesh.append(wall, side[i]);
  }
  for (const double z : {0.0, kTop + kRoom})
    scene.mesh.add_quad({-kHalfShaft, -kHalfShaft, z}, {kHalfShaft, -kHalfShaft, z}, {kHalfShaft, kHalfShaft, z},
                        {-kHalfShaft, kHalfShaft, z});
  scene.record_centre = Vector3d(kHalfShaft + 0.5 * kLobby, 0.0, 1.4);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.7219, Vector3d::UnitZ());
  scene.T_world_drawing.translation = Vector3d(2.317, 1.733, 0.191);

  constexpr double kStroll = 0.8, kClimb = 1.1;  // [m/s]
  const auto go = [&](const Vector3d& p, double speed) {
    scene.plan.waypoints.push_back({p + Vector3d(0, 0, kSceneImuHeight), speed});
  };
  const auto climb = [&](int i) {  // above the middle of step i; the slope begins and ends on the landings
    const double z = std::min(std::max(0.0, (i + 1) * kRise), kTop);
    go(on_circle(kWalkRadius, kFirstAngle + (i + 0.5) * kStepAngle, z), kClimb);
  };
  const auto lobby = [&](int i, double depth, double y) {
    go(side[i] * Vector3d(kHalfShaft + depth, y, i == 0 ? 0.0 : kTop), kStroll);
  };
  for (const auto& p : {std::array<double, 2>{3.0, -1.1}, {3.6, 0.4}, {2.4, 1.2}, {1.6, 0.5}, {0.0, 0.05}})
    lobby(0, p[0], p[1]);
  for (int i = -1; i <= kSteps; ++i) climb(i);
  for (const auto& p :
       {std::array<double, 2>{0.0, 0.0}, {1.6, -0.4}, {2.8, -0.9}, {3.5, 0.2}, {2.6, 0.9}, {1.4, 0.35}, {0.0, 0.0}})
    lobby(1, p[0], p[1]);
  for (int i = kSteps; i >= -1; --i) climb(i);
  for (const auto& p : {std::array<double, 2>{0.0, 0.05}, {1.6, 0.2}, {2.9, -0.6}}) lobby(0, p[0], p[1]);
  scene.plan.knot_interval = 0.35;
  return scene;
}

}  // namespace allan_lio
