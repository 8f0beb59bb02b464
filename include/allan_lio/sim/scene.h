// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/sim/mesh.h"
#include "allan_lio/sim/trajectory.h"

namespace allan_lio {

/// A place and a way through it, in the world frame (z up).
struct Scene {
  std::string name;
  TriangleMesh mesh;
  TrajectoryPlan plan;
  double max_range = 100.0;  ///< how far the LiDAR sees here unless told otherwise [m]
  /// From the frame of the round numbers in which the scene was drawn: an odd heading and offset, so that no wall
  /// lies conveniently on the borders of somebody's voxels.
  RigidTransform T_world_drawing;
};

std::vector<std::string> scene_names();

/// Throws std::invalid_argument naming the scenes that exist.
Scene make_scene(const std::string& name);

// The scenes as drawn: make_scene() takes them to the world.

/// An office floor of 20 m x 15 m: six rooms, a corridor, furniture. All six directions are seen from everywhere.
Scene make_rooms();

/// 150 m of bare straight walls between two halls, walked up and back. In the drawing the walls run along x.
Scene make_corridor();
constexpr double kCorridorLength = 150.0, kCorridorWidth = 2.5, kCorridorHeight = 2.6;  ///< [m]

/// A bent road tunnel of 300 m with ribs of 3 cm, driven through and back.
Scene make_tunnel();

}  // namespace allan_lio
