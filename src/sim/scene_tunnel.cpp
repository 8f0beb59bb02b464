// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/sim/scene.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kTunnelLength = 300.0, kBendRadius = 800.0, kTunnelRadius = 3.0;  // [m]
constexpr double kAxisHeight = 1.8;  // of the section's centre above the floor
constexpr double kRibSpacing = 5.0, kRibWidth = 0.25, kRibHeight = 0.03;
constexpr double kApron = 45.0, kApronHalfWidth = 18.0;  // the ground before either portal
constexpr double kImuHeight = 1.2;
constexpr double kRecordDepth = 30.0;  // where a recorded way is put: the near portal is a small opening there

/// The place `side` to the left of the axis at arc length `s`; beyond the portals the axis runs on straight.
Vector3d place(double s, double side, double z) {
  const double inside = std::min(std::max(s, 0.0), kTunnelLength);
  const double angle = inside / kBendRadius;
  const double straight = s - inside;
  return {(kBendRadius - side) * std::sin(angle) + straight * std::cos(angle),
          kBendRadius - (kBendRadius - side) * std::cos(angle) + straight * std::sin(angle), z};
}

/// The section's outline above the floor at arc length `s`, from the right foot over the crown to the left foot.
std::vector<Vector3d> outline(double s, double radius) {
  constexpr int kSides = 40;
  const double foot = std::asin(kAxisHeight / radius);  // below the horizontal
  std::vector<Vector3d> points;
  for (int i = 0; i <= kSides; ++i) {
    const double angle = -foot + (kPi + 2.0 * foot) * i / kSides;
    points.push_back(place(s, -radius * std::cos(angle), kAxisHeight + radius * std::sin(angle)));
  }
  return points;
}

/// Joins two outlines by a strip of triangles' pairs.
void add_strip(TriangleMesh& mesh, const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  for (std::size_t i = 0; i + 1 < a.size(); ++i) mesh.add_quad(a[i], a[i + 1], b[i + 1], b[i]);
}

/// Without ribs the bend is cut into short pieces, so that no kinks take their place.
void add_lining(TriangleMesh& mesh, bool ribs) {
  std::vector<Vector3d> last = outline(0.0, kTunnelRadius);
  const auto go_on = [&](double s, double radius) {
    const std::vector<Vector3d> next = outline(s, radius);
    add_strip(mesh, last, next);
    last = next;
  };
  for (int s = 1; !ribs && s < static_cast<int>(kTunnelLength); ++s) go_on(s, kTunnelRadius);
  for (double s = kRibSpacing; ribs && s < kTunnelLength - 0.5 * kRibSpacing; s += kRibSpacing) {
    go_on(s - 0.5 * kRibWidth, kTunnelRadius);
    go_on(s - 0.5 * kRibWidth, kTunnelRadius - kRibHeight);
    go_on(s + 0.5 * kRibWidth, kTunnelRadius - kRibHeight);
    go_on(s + 0.5 * kRibWidth, kTunnelRadius);
  }
  go_on(kTunnelLength, kTunnelRadius);
  const double begin = -kApron, end = kTunnelLength + kApron, half = kApronHalfWidth;
  mesh.add_quad(place(begin, -half, 0) - Vector3d(50, 0, 0), place(end, -half, 0) + Vector3d(50, 0, 0),
                place(end, 4 * half, 0), place(begin, 4 * half, 0));
}

/// Portal wall and what stands before it; `out` is +1 at the far end and -1 at the near one.
void add_portal(TriangleMesh& mesh, double s, double out) {
  add_strip(mesh, outline(s, kTunnelRadius), outline(s, 4.0 * kTunnelRadius));
  const auto block = [&](double depth, double side, const Vector3d& size, double yaw) {
    const Vector3d centre = place(s + out * depth, side, 0.5 * size.z());
    mesh.add_box(centre - 0.5 * size, centre + 0.5 * size, yaw);
  };
  block(4.0, -6.5, {2.4, 3.0, 2.6}, 0.3);  // switch house
  block(9.0, 6.8, {6.0, 0.5, 0.9}, 0.12);  // barriers
  block(16.0, -7.2, {7.0, 0.5, 0.9}, -0.2);
  block(27.0, 13.5, {4.0, 8.0, 4.0}, 0.5);  // buildings
  block(40.0, -4.0, {3.0, 12.0, 5.0}, 0.25);
  block(20.0, -14.0, {9.0, 3.0, 3.5}, 0.15);
  for (const double depth : {3.0, 11.0, 19.0, 30.0}) {
    mesh.add_pillar(place(s + out * depth, 10.5, 0).head<2>(), 0.15, 0.0, 6.0);
    mesh.add_pillar(place(s + out * (depth + 2.0), -9.7, 0).head<2>(), 0.15, 0.0, 6.0);
  }
  mesh.add_panel(place(s + out * 13.0, 7.6, 1.0), 2.0, 2.0, 0.7, 0.2);
}

TrajectoryPlan drive() {
  constexpr double kCrawl = 2.5, kDrive = 7.0, kLane = 0.9;  // [m/s], [m/s], [m]
  TrajectoryPlan plan;
  const auto go = [&](double s, double side, double speed) {
    plan.waypoints.push_back({place(s, side, kImuHeight), speed});
  };
  go(-26.0, 2.3, kCrawl);
  go(-18.0, -0.4, kCrawl);
  go(-9.0, -kLane, kCrawl);
  for (double s = 0.0; s <= kTunnelLength + 10.0; s += 10.0) go(s, -kLane, kDrive);
  go(kTunnelLength + 18.0, -2.0, kDrive);
  const double loop[][2] = {{24.0, -1.6}, {28.0, -0.4}, {30.5, 2.8}, {29.6, 6.2},
                            {26.4, 8.0},  {22.5, 7.2},  {17.0, 3.4}};
  for (const auto& p : loop) go(kTunnelLength + p[0], p[1], kCrawl);
  go(kTunnelLength + 10.0, kLane, kCrawl);
  for (double s = kTunnelLength; s >= -5.0; s -= 10.0) go(s, kLane, kDrive);
  go(-16.0, 1.2, kDrive);
  plan.acceleration = 1.2;
  plan.knot_interval = 0.5;
  plan.gait = {1.43, 0.008, 0.01, 0.006, 0.005, 0.002, 2.0};
  return plan;
}

Scene make(bool ribs) {
  Scene scene;
  add_lining(scene.mesh, ribs);
  add_portal(scene.mesh, 0.0, -1.0);
  add_portal(scene.mesh, kTunnelLength, 1.0);
  scene.plan = drive();
  scene.record_centre = place(kRecordDepth, 0.0, kAxisHeight);
  scene.record_heading = kRecordDepth / kBendRadius;
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.9233, Vector3d::UnitZ());
  scene.T_world_drawing.translation = Vector3d(-7.193, 4.711, 0.527);
  return scene;
}

}  // namespace

Scene make_tunnel() { return make(true); }

Scene make_tunnel_smooth() { return make(false); }

}  // namespace allan_lio
