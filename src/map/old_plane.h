// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "allan_lio/map/epoch_sieve.h"
#include "allan_lio/map/old_plane_box.h"
#include "allan_lio/map/voxel_map.h"
#include "allan_lio/map/voxel_store.h"
#include "plane_voxel.h"

namespace allan_lio {

/// The old planes in a cube: those of `last_epoch` or before.
OldCube old_cube(const VoxelStore<PlaneVoxel>& store, const VoxelCoordinates& c, std::uint32_t last_epoch);

/// VoxelMap::find_old() in the voxels up to one edge around the point.
const Plane* find_old_plane(const VoxelStore<PlaneVoxel>& store, const Eigen::Vector3d& point,
                            const Eigen::Vector3d& sensor, const OldPlanes& old_planes);

/// VoxelMap::gather_old().
bool gather_old_planes(const VoxelStore<PlaneVoxel>& store, const EpochSieve& sieve, const Eigen::AlignedBox3d& box,
                       std::uint32_t last_epoch, OldPlaneBox& out);

/// From the side that it was made from, and, where it is narrow, from about the same direction.
inline bool is_seen_alike(const Plane& plane, const Eigen::Vector3d& beam) {
  constexpr double kNarrow = 0.45;   // [m]
  constexpr double kSameView = 0.9;  // cosine between two views of a narrow plane: 26 deg
  if (plane.normal.dot(beam) * plane.normal.dot(plane.view) <= 0.0) return false;
  return plane.width >= kNarrow || beam.dot(plane.view) >= kSameView;
}

/// VoxelMap::find_old() in cubes of which `cube_at(x, y, z)` says what old planes they have.
template <class CubeAt>
const Plane* nearest_of(const CubeAt& cube_at, const Eigen::Vector3d& point, const Eigen::Vector3d& sensor,
                        double reach, double inverse_edge) {
  constexpr double kFarthest = 1.0;  // of the edge: farther off a point is not looked for
  const Eigen::Vector3d scaled = point * inverse_edge, beam = (point - sensor).normalized();
  const double steps = std::min(reach * inverse_edge, kFarthest);
  int low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::floor(scaled[k] - steps));
    high[k] = static_cast<int>(std::floor(scaled[k] + steps));
  }
  const Plane* nearest = nullptr;
  double least = reach;
  const auto look_into = [&](int x, int y, int z) {
    const OldCube cube = cube_at(x, y, z);
    for (const Plane* plane : {cube.first, cube.second}) {
      if (!plane) continue;
      const double distance = std::abs(plane->distance(point));
      if (distance < least && in_same_cube(voxel_of(plane->foot(point), inverse_edge), {x, y, z}) &&
          is_seen_alike(*plane, beam)) {
        nearest = plane;
        least = distance;
      }
    }
  };
  // The nearest is likely to be in the point's own cube; and in none that is farther away than the nearest so far.
  const VoxelCoordinates home = voxel_of(point, inverse_edge);
  look_into(home.x, home.y, home.z);
  const auto beside = [&scaled](int k, int cube) { return std::max({0.0, cube - scaled[k], scaled[k] - (cube + 1)}); };
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y) {
      const double aside = beside(0, x) * beside(0, x) + beside(1, y) * beside(1, y);
      for (int z = low[2]; z <= high[2]; ++z) {
        const double steps_away = aside + beside(2, z) * beside(2, z), within = least * inverse_edge;
        if (steps_away > within * within || (x == home.x && y == home.y && z == home.z)) continue;
        look_into(x, y, z);
      }
    }
  return nearest;
}

}  // namespace allan_lio
