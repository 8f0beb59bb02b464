// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/old_plane_box.h"

#include "old_plane.h"

namespace allan_lio {
namespace {

constexpr double kRounding = 1e-6;       ///< of the edge, by which a box is larger than asked for
constexpr double kMostCubes = 10'000.0;  ///< 160 kB; a box of 4 m at edges of 0.5 m has 1000
constexpr double kFarthest = 1 << 20;    ///< cubes from the origin: voxel_key()'s

}  // namespace

bool OldPlaneBox::begin(const Eigen::AlignedBox3d& box, double inverse_edge) {
  const Eigen::Array3d low = (box.min().array() * inverse_edge - kRounding).floor();
  const Eigen::Array3d size = (box.max().array() * inverse_edge + kRounding).floor() - low + 1.0;
  const bool fits = size.prod() <= kMostCubes && size.minCoeff() >= 1.0 && low.abs().maxCoeff() < kFarthest;
  for (int k = 0; k < 3; ++k) {
    low_[k] = fits ? static_cast<int>(low[k]) : 0;
    size_[k] = fits ? static_cast<int>(size[k]) : 0;
  }
  cubes_.assign(fits ? static_cast<std::size_t>(size.prod()) : 0, OldCube{});
  inverse_edge_ = inverse_edge;
  empty_ = true;
  return fits;
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
