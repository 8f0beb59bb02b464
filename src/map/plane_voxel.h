// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/map/plane.h"
#include "allan_lio/map/voxel_index.h"

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

}  // namespace allan_lio
