// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/map/old_plane_box.h"
#include "plane_voxel.h"

namespace allan_lio {
namespace {

constexpr double kNarrow = 0.45;    ///< [m]
constexpr double kSameView = 0.9;   ///< cosine between two views of a narrow plane: 26 deg
constexpr double kRounding = 1e-6;  ///< of the edge, by which a box is larger than asked for
constexpr double kFarthest = 1.0;   ///< of the edge: farther off a point is not looked for

bool is_seen_alike(const Plane& plane, const Eigen::Vector3d& beam) {
  if (plane.normal.dot(beam) * plane.normal.dot(plane.view) <= 0.0) return false;
  return plane.width >= kNarrow || beam.dot(plane.view) >= kSameView;
}

/// VoxelMap::find_old() in cubes of which `cube_at(x, y, z)` says what old planes they have.
template <class CubeAt>
const Plane* nearest_of(const CubeAt& cube_at, const Eigen::Vector3d& point, const Eigen::Vector3d& sensor,
                        double reach, double inverse_edge) {
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

}  // namespace

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

void OldPlaneBox::begin(const Eigen::AlignedBox3d& box, double inverse_edge) {
  inverse_edge_ = inverse_edge;
  for (int k = 0; k < 3; ++k) {
    low_[k] = static_cast<int>(std::floor(box.min()[k] * inverse_edge - kRounding));
    size_[k] = static_cast<int>(std::floor(box.max()[k] * inverse_edge + kRounding)) - low_[k] + 1;
  }
  cubes_.assign(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2], OldCube{});
  empty_ = true;
}

std::size_t OldPlaneBox::number_of(int x, int y, int z) const {
  return (static_cast<std::size_t>(x - low_[0]) * size_[1] + (y - low_[1])) * size_[2] + (z - low_[2]);
}

void OldPlaneBox::put(const VoxelCoordinates& c, const OldCube& cube) {
  cubes_[number_of(c.x, c.y, c.z)] = cube;
  empty_ = empty_ && cube.empty();
}

const Plane* OldPlaneBox::find(const Eigen::Vector3d& point, const Eigen::Vector3d& sensor, double reach) const {
  if (empty_) return nullptr;
  const auto cube_at = [this](int x, int y, int z) { return cubes_[number_of(x, y, z)]; };
  return nearest_of(cube_at, point, sensor, reach, inverse_edge_);
}

}  // namespace allan_lio
