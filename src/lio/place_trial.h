// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "allan_lio/lio/lio_result.h"
#include "allan_lio/map/voxel_map.h"

namespace allan_lio {

/// Of a scan: along the axes of the world [m] and about its vertical through the IMU, the latter as the way of a point
/// at the lever [m].
using PlaceOffset = Eigen::Vector4d;

struct PlaceCandidate {
  PlaceOffset at = PlaceOffset::Zero();
  double fit = 0.0;    ///< points that fit, each by how well it does
  double told = 0.0;   ///< what they tell for it [nat]
  double prior = 0.0;  ///< logarithm of its probability before, less that of no offset [nat]

  double score() const { return told + prior; }
};

/// A scan that is tried on old planes at places around.
class PlaceTrial {
 public:
  static constexpr double kFarthest = 2.0;  ///< [m]
  static constexpr double kCoarse = 0.25;   ///< step [m]; a point fits within it
  static constexpr double kFine = 0.12;     ///< [m], within which a point fits in the end

  /// `points`: the scan in the IMU's frame at the state [m]; `last_epoch` of the planes it is tried on; `sigmas` of the
  /// position in the world [m] and the heading [rad]. Of the points those on planes that no offset within reach moves
  /// are left out: they fit everywhere. The map must outlive it.
  PlaceTrial(const std::vector<Eigen::Vector3f>& points, const LioState& state, const VoxelMap& map,
             std::uint32_t last_epoch, const Eigen::Vector4d& sigmas);

  /// That are tried.
  std::size_t points() const { return points_.size(); }

  /// The offset as a step of the pose: rotation in the IMU's frame [rad], translation in the world [m].
  PoseVector step(const PlaceOffset& at) const;

  /// Of a turn by one radian the way of a point at the lever [m], which is the scan's own.
  double lever() const { return lever_; }

  /// By all points that are tried; one fits within kFine.
  PlaceCandidate judge(const PlaceOffset& at) const;

  /// Of the coarse steps within reach, or within what of it can be looked through, by a part of the points: the best
  /// that lies at least `apart` [m] from `from`. They are tried once.
  std::optional<PlaceCandidate> best_on_grid(const PlaceOffset& from, double apart);

  /// The best of those half a coarse step around, from where it climbs by ever smaller steps along each axis.
  PlaceCandidate refine(const PlaceOffset& from) const;

 private:
  void choose_points(const std::vector<Eigen::Vector3f>& points);
  /// Fills grid_.
  void try_grid();
  /// Adds to the grid's fits how well this point fits there.
  void try_point(const Eigen::Vector3d& q, const std::vector<Eigen::Matrix3d>& rotations, OldPlaneBox& box);
  Eigen::Matrix3d rotation_at(double turn) const;
  /// `fit` of so many points becomes that of all; what they tell, and the prior, follow.
  void complete(std::size_t points, PlaceCandidate& candidate) const;
  std::array<int, 4> steps_within_reach() const;

  RigidTransform pose_;
  const VoxelMap& map_;
  std::uint32_t last_epoch_;
  Eigen::Vector3d position_sigmas_;  ///< [m]
  double heading_sigma_;             ///< [rad]
  PlaceOffset sigmas_ = PlaceOffset::Zero();
  double lever_ = 1.0;  ///< root mean square of the points' horizontal distances [m]
  std::vector<Eigen::Vector3d> points_, few_;
  std::vector<PlaceCandidate> grid_;  ///< empty until it is asked for
};

}  // namespace allan_lio
