// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace allan_lio {
namespace {

void place_in_world(Scene& scene) {
  for (Eigen::Vector3d& vertex : scene.mesh.vertices) vertex = scene.T_world_drawing * vertex;
  for (Waypoint& waypoint : scene.plan.waypoints) waypoint.position = scene.T_world_drawing * waypoint.position;
}

struct NamedScene {
  const char* name;
  Scene (*make)();
};

constexpr NamedScene kScenes[] = {{"rooms", make_rooms},
                                  {"corridor", make_corridor},
                                  {"tunnel", make_tunnel},
                                  {"corridor_turn", make_corridor_turn},
                                  {"tunnel_smooth", make_tunnel_smooth},
                                  {"field", make_field},
                                  {"hall", make_hall},
                                  {"stairwell", make_stairwell},
                                  {"bridge", make_bridge},
                                  {"city", make_city}};

}  // namespace

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.push_back(scene.name);
  return names;
}

Scene make_scene(const std::string& name) {
  const auto* found =
      std::find_if(std::begin(kScenes), std::end(kScenes), [&](const NamedScene& scene) { return scene.name == name; });
  if (found == std::end(kScenes)) {
    std::string known;
    for (const std::string& one : scene_names()) known += (known.empty() ? "" : ", ") + one;
    throw std::invalid_argument("there is no scene '" + name + "'; there are " + known);
  }
  Scene scene = found->make();
  scene.name = name;
  place_in_world(scene);
  return scene;
}

std::optional<double> first_collision(const Motion& motion, const RayCaster& caster) {
  constexpr double kStep = 0.1;  // [s]
  Eigen::Vector3d here = motion.at(0.0).T_world_imu.translation;
  for (double t = kStep; t < motion.duration() + kStep; t += kStep) {
    const Eigen::Vector3d there = motion.at(t).T_world_imu.translation;
    const double distance = (there - here).norm();
    if (distance > 1e-6 && caster.cast(here, (there - here) / distance, distance)) return t;
    here = there;
  }
  return std::nullopt;
}

}  // namespace allan_lio
