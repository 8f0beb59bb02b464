// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/scene.h"

#include <stdexcept>

namespace allan_lio {
namespace {

void place_in_world(Scene& scene) {
  for (Eigen::Vector3d& vertex : scene.mesh.vertices) vertex = scene.T_world_drawing * vertex;
  for (Waypoint& waypoint : scene.plan.waypoints) waypoint.position = scene.T_world_drawing * waypoint.position;
}

}  // namespace

std::vector<std::string> scene_names() { return {"rooms", "corridor", "tunnel"}; }

Scene make_scene(const std::string& name) {
  Scene scene;
  if (name == "rooms") {
    scene = make_rooms();
  } else if (name == "corridor") {
    scene = make_corridor();
  } else if (name == "tunnel") {
    scene = make_tunnel();
  } else {
    std::string known;
    for (const std::string& one : scene_names()) known += (known.empty() ? "" : ", ") + one;
    throw std::invalid_argument("there is no scene '" + name + "'; there are " + known);
  }
  scene.name = name;
  place_in_world(scene);
  return scene;
}

}  // namespace allan_lio
