// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "allan_lio/sim/motion_profile.h"
#include "allan_lio/sim/scene.h"
#include "scene_parts.h"

namespace allan_lio {
namespace {

constexpr double kLength = 240.0, kHalfWidth = 4.5, kPostSpacing = 8.0;  // [m]
constexpr double kBank = 75.0, kBankHalfWidth = 30.0;                    // the ground before either end

void add_deck(TriangleMesh& mesh) {
  add_ground(mesh, {0, -kHalfWidth}, {kLength, kHalfWidth});  // below it is water, which returns nothing
  for (const double side : {-1.0, 1.0}) {
    const auto bar = [&](double from, double to, double low, double high) {
      mesh.add_box({0, side > 0 ? from : -to, low}, {kLength, side > 0 ? to : -from, high});
    };
    bar(4.1, kHalfWidth, 0.0, 0.22);  // kerb
    for (const double z : {0.5, 0.8, 1.1}) bar(4.33, 4.39, z - 0.03, z + 0.03);
    for (double x = 0.5 * kPostSpacing; x < kLength; x += kPostSpacing)
      mesh.add_box({x - 0.02, side * 4.42 - 0.02, 0.22}, {x + 0.02, side * 4.42 + 0.02, 1.15});
  }
}

/// The bank beyond x = `end`; `out` is the direction away from the bridge, +1 or -1.
void add_bank(TriangleMesh& mesh, double end, double out) {
  const double far = end + out * kBank;
  add_ground(mesh, {std::min(end, far), -kBankHalfWidth}, {std::max(end, far), kBankHalfWidth});
  const auto block = [&](double depth, double side, const Eigen::Vector3d& size, double yaw) {
    add_block(mesh, {end + out * depth, side}, size, yaw);
  };
  block(3.0, -8.5, {3.0, 4.0, 3.2}, 0.2);  // toll house
  block(6.0, 8.0, {5.0, 0.5, 0.9}, 0.15);  // barriers
  block(15.0, -8.0, {6.0, 0.5, 0.9}, -0.2);
  block(25.0, 16.0, {6.0, 9.0, 6.0}, 0.45);  // houses
  block(46.0, -5.0, {4.0, 14.0, 7.0}, 0.25);
  block(20.0, -16.0, {9.0, 5.0, 5.0}, 0.15);
  block(52.0, 16.0, {7.0, 8.0, 6.0}, -0.3);
  add_car(mesh, {end + out * 11.0, -6.6}, 0.1);
  add_car(mesh, {end + out * 36.0, 11.5}, 1.2);
  for (const double depth : {2.0, 9.0, 17.0, 30.0, 41.0}) {
    mesh.add_pillar({end + out * depth, 11.0}, 0.15, 0.0, 6.0);
    mesh.add_pillar({end + out * (depth + 3.0), -10.5}, 0.15, 0.0, 6.0);
  }
  mesh.add_panel({end + out * 13.0, 7.4, 1.0}, 2.0, 2.0, 0.7, 0.2);
}

}  // namespace

Scene make_bridge() {
  Scene scene;
  scene.max_range = 60.0;
  add_deck(scene.mesh);
  add_bank(scene.mesh, 0.0, -1.0);
  add_bank(scene.mesh, kLength, 1.0);
  scene.record_centre = Eigen::Vector3d(30.0, 0.0, 1.8);
  scene.T_world_drawing.rotation = Eigen::AngleAxisd(0.6173, Eigen::Vector3d::UnitZ());
  scene.T_world_drawing.translation = Eigen::Vector3d(8.713, -5.119, 0.471);

  constexpr double kCrawl = 2.5, kDrive = 7.0, kLane = 1.6;  // [m/s], [m/s], [m]
  const auto go = [&](double x, double y, double speed) {
    scene.plan.waypoints.push_back({{x, y, kSceneImuHeight}, speed});
  };
  go(-26.0, 2.3, kCrawl);
  go(-18.0, -0.6, kCrawl);
  go(-8.0, -kLane, kCrawl);
  for (double x = 0.0; x <= kLength; x += 20.0) go(x, -kLane, kDrive);
  const double round[][2] = {{12.0, -1.8}, {22.0, -1.9}, {27.5, -0.4}, {29.5, 3.0},
                             {27.5, 6.4},  {22.5, 6.2},  {14.0, 2.2}};
  for (const auto& p : round) go(kLength + p[0], p[1], kCrawl);
  for (double x = kLength; x >= 0.0; x -= 20.0) go(x, kLane, kDrive);
  go(-16.0, 1.2, kDrive);
  scene.plan.acceleration = 1.2;
  scene.plan.knot_interval = 0.5;
  apply_motion_profile("driving", 1, scene.plan);
  return scene;
}

}  // namespace allan_lio
