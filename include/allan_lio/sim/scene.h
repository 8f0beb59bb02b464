// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/sim/mesh.h"
#include "allan_lio/sim/ray_caster.h"
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
  /// Where the middle of a recorded way is put, in the drawing, and the drawing's direction along which it is turned.
  Eigen::Vector3d record_centre = Eigen::Vector3d::Zero();  ///< [m]
  double record_heading = 0.0;                              ///< [rad]
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

/// An L of two such corridors of 60 m, a hall at either end, walked there and back. The LiDAR sees 20 m, so that from
/// the middle of either leg neither hall nor bend is in sight. In the drawing the first leg runs along x.
Scene make_corridor_turn();
constexpr double kCornerLeg = 60.0;  ///< [m]

/// A bent road tunnel of 300 m with ribs of 3 cm, driven through and back.
Scene make_tunnel();

/// The same without ribs: a round tube with a floor.
Scene make_tunnel_smooth();

/// Flat ground with a few far poles, driven over in loops.
Scene make_field();

/// 200 m x 130 m with a few columns, walked through with a LiDAR that sees 30 m: neither walls nor ceiling.
Scene make_hall();

/// Four narrow turns of a spiral staircase between two furnished rooms, walked up and down.
Scene make_stairwell();

/// A deck of 240 m with kerbs and railings over water that returns nothing, driven over and back; the LiDAR sees 60 m.
Scene make_bridge();

/// A street canyon round a block: houses, parked cars, poles. Well conditioned: the control.
Scene make_city();

/// When a straight line between two poses 0.1 s apart first meets a surface, if ever [s]: such a motion goes
/// through a wall.
std::optional<double> first_collision(const Motion& motion, const RayCaster& caster);

}  // namespace allan_lio
