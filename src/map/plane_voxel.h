// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/map/old_plane_box.h"
#include "allan_lio/map/plane.h"
#include "allan_lio/map/voxel_map.h"
#include "allan_lio/map/voxel_store.h"

namespace allan_lio {

struct PlaneVoxel {
  VoxelCoordinates coordinates{};
  std::uint32_t fitted_at = 0;  ///< count at the last fit
  double epochs = 0.0;          ///< sum over the points
  bool is_plane = false;
  bool is_divided = false;  ///< there is a second voxel at the same place
  bool is_touched = false;
  PlaneSums sums;  ///< about the voxel's center
  Plane plane;
};

/// The old planes in a cube: those of `last_epoch` or before.
OldCube old_cube(const VoxelStore<PlaneVoxel>& store, const VoxelCoordinates& c, std::uint32_t last_epoch);

/// VoxelMap::find_old() in the voxels up to one edge around the point.
const Plane* find_old_plane(const VoxelStore<PlaneVoxel>& store, const Eigen::Vector3d& point,
                            const Eigen::Vector3d& sensor, const OldPlanes& old_planes);

}  // namespace allan_lio
