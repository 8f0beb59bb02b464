// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "plane_voxel.h"

namespace allan_lio {
namespace {

constexpr double kNarrow = 0.45;   ///< [m]
constexpr double kSameView = 0.9;  ///< cosine between two views of a narrow plane: 26 deg
constexpr double kFarthest = 1.0;  ///< of the edge: farther off a point is not looked for

bool is_seen_alike(const Plane& plane, const Eigen::Vector3d& beam) {
  if (plane.normal.dot(beam) * plane.normal.dot(plane.view) <= 0.0) return false;
  return plane.width >= kNarrow || beam.dot(plane.view) >= kSameView;
}

}  // namespace

const Plane* find_old_plane(const VoxelStore<PlaneVoxel>& store, const Eigen::Vector3d& point,
                            const Eigen::Vector3d& sensor, const OldPlanes& old_planes) {
  const Eigen::Vector3d scaled = point * store.inverse_edge(), beam = (point - sensor).normalized();
  const double steps = std::min(old_planes.reach * store.inverse_edge(), kFarthest);
  int low[3], high[3];
  for (int k = 0; k < 3; ++k) {
    low[k] = static_cast<int>(std::floor(scaled[k] - steps));
    high[k] = static_cast<int>(std::floor(scaled[k] + steps));
  }
  const Plane* nearest = nullptr;
  double least = old_planes.reach;
  const auto look_into = [&](int x, int y, int z) {
    for (const bool second : {false, true}) {
      const VoxelCoordinates c{x, y, z, second};
      const PlaneVoxel* voxel = store.find(c);
      if (!voxel) return;
      const Plane& plane = voxel->plane;
      if (voxel->is_plane && plane.epoch <= old_planes.last_epoch) {
        const double distance = std::abs(plane.distance(point));
        if (distance < least && in_same_cube(voxel_of(plane.foot(point), store.inverse_edge()), c) &&
            is_seen_alike(plane, beam)) {
          nearest = &plane;
          least = distance;
        }
      }
      if (!voxel->is_divided) return;
    }
  };
  // The nearest is likely to be in the point's own cube; and in none that is farther away than the nearest so far.
  const VoxelCoordinates home = voxel_of(point, store.inverse_edge());
  look_into(home.x, home.y, home.z);
  const auto beside = [&scaled](int k, int cube) { return std::max({0.0, cube - scaled[k], scaled[k] - (cube + 1)}); };
  for (int x = low[0]; x <= high[0]; ++x)
    for (int y = low[1]; y <= high[1]; ++y) {
      const double aside = beside(0, x) * beside(0, x) + beside(1, y) * beside(1, y);
      for (int z = low[2]; z <= high[2]; ++z) {
        const double steps_away = aside + beside(2, z) * beside(2, z), within = least * store.inverse_edge();
        if (steps_away > within * within || (x == home.x && y == home.y && z == home.z)) continue;
        look_into(x, y, z);
      }
    }
  return nearest;
}

}  // namespace allan_lio
