// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

#include "allan_lio/map/plane.h"
#include "allan_lio/map/voxel_index.h"

namespace allan_lio {

/// The old planes of one cube; null where there is none.
struct OldCube {
  const Plane* first = nullptr;
  const Plane* second = nullptr;

  bool empty() const { return !first && !second; }
};

/// The old planes in a box, for one point that is tried at many places in it: the map is asked once for each cube.
class OldPlaneBox {
 public:
  /// Empties it and makes room for the cubes that touch the box [m, world], `inverse_edge` [1/m]. False if they are too
  /// many, or too far away.
  bool begin(const Eigen::AlignedBox3d& box, double inverse_edge);
  VoxelCoordinates low() const { return {low_[0], low_[1], low_[2]}; }
  VoxelCoordinates high() const { return {low_[0] + size_[0] - 1, low_[1] + size_[1] - 1, low_[2] + size_[2] - 1}; }
  /// The cube lies between low() and high().
  void put(const VoxelCoordinates& c, const OldCube& cube);

  /// No plane in it.
  bool empty() const { return empty_; }

  /// What VoxelMap::find_old() finds for this point, seen from `sensor` [m, world]; what lies within `reach` [m] of the
  /// point must be in the box.
  const Plane* find(const Eigen::Vector3d& point, const Eigen::Vector3d& sensor, double reach) const;

 private:
  std::size_t number_of(int x, int y, int z) const;

  double inverse_edge_ = 1.0;  ///< [1/m]
  std::array<int, 3> low_{}, size_{};
  std::vector<OldCube> cubes_;
  bool empty_ = true;
};

}  // namespace allan_lio
