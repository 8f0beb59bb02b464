// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "allan_lio/map/old_plane_box.h"
#include "allan_lio/map/plane.h"

namespace allan_lio {

struct VoxelMapOptions {
  double voxel_size;   ///< [m]
  double range_noise;  ///< 1 sigma of a point [m]
  double radius;       ///< voxels farther than this go first when the map is full [m]
  double max_mb;       ///< hard cap [MB = 1e6 bytes]
};

/// What a run that has drifted looks for around its points: planes from before.
struct OldPlanes {
  double reach = 0.0;            ///< how far aside they may lie [m]; 0: there are none to look for
  std::uint32_t last_epoch = 0;  ///< of the planes from before
};

/// Local map: hashed voxels, bounded in memory, the same for the same sequence of calls.
class VoxelMap {
 public:
  virtual ~VoxelMap() = default;

  /// Adds points [m, world], seen from `sensor` [m, world]; makes room when the map is full. `epoch` marks what they
  /// make, so that it is known later which planes share an error of placement; it never falls before clear().
  virtual void insert(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& sensor,
                      std::uint32_t epoch = 0) = 0;

  /// The plane that a point is to be compared with, or null. It lies in the map or in `scratch`.
  /// Safe to call from several threads.
  virtual const Plane* find(const Eigen::Vector3d& point, Plane& scratch) const = 0;

  /// The nearest of the old planes within reach of a point that `sensor` sees [m, world], or null. Only one at most a
  /// voxel aside, whose voxel the point's foot lies in, that was seen from the same side, and, where it is narrow, from
  /// about the same direction: from another one a pillar shows another surface. A map that keeps no planes finds none.
  /// Safe to call from several threads.
  virtual const Plane* find_old(const Eigen::Vector3d& /*point*/, const Eigen::Vector3d& /*sensor*/,
                                const OldPlanes& /*old_planes*/) const {
    return nullptr;
  }

  /// The old planes, of `last_epoch` or before, in a box [m, world], so that find_old() need not ask the map again for
  /// each of many places. They stay valid until the next insert() or clear(). False if the box is too large for that.
  /// Safe to call from several threads.
  virtual bool gather_old(const Eigen::AlignedBox3d& /*box*/, std::uint32_t /*last_epoch*/, OldPlaneBox& out) const {
    out = OldPlaneBox();
    return true;
  }

  virtual void clear() = 0;
  virtual std::size_t voxels() const = 0;
  virtual std::size_t bytes() const = 0;

  /// What stands for the map in a picture: its points or its planes' centers [m, world].
  virtual std::vector<Eigen::Vector3d> points() const = 0;
};

/// One growing plane per voxel: sums of the points, so that a plane's noise falls with every visit. Points too far from
/// the plane make a second one in the same voxel: the other side of a thin wall, or the next wall in a corner.
std::unique_ptr<VoxelMap> make_plane_voxel_map(const VoxelMapOptions& options);

/// Thinned points per voxel; a plane is fitted to the five nearest at every look-up.
std::unique_ptr<VoxelMap> make_point_voxel_map(const VoxelMapOptions& options);

}  // namespace allan_lio
