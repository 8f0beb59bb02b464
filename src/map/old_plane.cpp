// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "old_plane.h"

namespace allan_lio {

OldCube old_cube(const VoxelStore<PlaneVoxel>& store, const VoxelCoordinates& c, std::uint32_t last_epoch) {
  const auto old_plane = [last_epoch](const PlaneVoxel* voxel) {
    return voxel && voxel->is_plane && voxel->plane.epoch <= last_epoch ? &voxel->plane : nullptr;
  };
  const PlaneVoxel* first = store.find(c);
  if (!first) return {};
  return {old_plane(first), first->is_divided ? old_plane(store.find({c.x, c.y, c.z, true})) : nullptr};
}

const Plane* find_old_plane(const VoxelStore<PlaneVoxel>& store, const Eigen::Vector3d& point,
                            const Eigen::Vector3d& sensor, const OldPlanes& old_planes) {
  const auto cube_at = [&](int x, int y, int z) { return old_cube(store, {x, y, z}, old_planes.last_epoch); };
  return nearest_of(cube_at, point, sensor, old_planes.reach, store.inverse_edge());
}

bool gather_old_planes(const VoxelStore<PlaneVoxel>& store, const EpochSieve& sieve, const Eigen::AlignedBox3d& box,
                       std::uint32_t last_epoch, OldPlaneBox& out) {
  if (!out.begin(box, store.inverse_edge())) return false;
  const VoxelCoordinates low = out.low(), high = out.high();
  for (int x = low.x; x <= high.x; ++x)
    for (int y = low.y; y <= high.y; ++y)
      for (int z = low.z; z <= high.z; ++z)
        if (sieve.may_be_near({x, y, z}, last_epoch)) out.put({x, y, z}, old_cube(store, {x, y, z}, last_epoch));
  return true;
}

}  // namespace allan_lio
