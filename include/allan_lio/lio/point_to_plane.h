// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "allan_lio/lio/column_sums.h"
#include "allan_lio/lio/lio_result.h"
#include "allan_lio/lio/residual_noise.h"
#include "allan_lio/lio/task_pool.h"
#include "allan_lio/map/voxel_map.h"

namespace allan_lio {

/// Columns of the residual's Jacobian: rotation and translation of the IMU, rotation and translation of the LiDAR.
constexpr int kResidualDof = 12;
using ResidualMatrix = Eigen::Matrix<double, kResidualDof, kResidualDof>;
using ResidualVector = Eigen::Matrix<double, kResidualDof, 1>;

using PoseRows = Eigen::Matrix<double, 6, kResidualDof>;

/// The points see one pose, the LiDAR's: an error of the extrinsics moves them in the world as some error of the IMU's
/// pose would. These are [I, A]: the error of the IMU's pose itself, and the one (A) that equals the extrinsics'; A is
/// left zero unless the extrinsics are estimated.
PoseRows lidar_pose_rows(const LioState& state, bool estimate_extrinsics);

/// The scan's points as a quadratic cost about a state: cost = x^T information x / 2 - gradient^T x.
struct NormalEquations {
  ResidualMatrix information = ResidualMatrix::Zero();
  ResidualVector gradient = ResidualVector::Zero();
  /// What the noise of the planes' normals adds to the information of the pose in expectation, though it tells
  /// nothing: sum of w E[dh dh^T] over the residuals' Jacobians h (theory section 4).
  PoseMatrix feigned = PoseMatrix::Zero();
  /// Covariance of the pose's gradient from the planes' own errors, which stay the same from scan to scan.
  PoseMatrix plane_scatter = PoseMatrix::Zero();
  double squared_range = 0.0;     ///< sum of |q|^2 over the inliers [m^2]
  double squared_distance = 0.0;  ///< sum of z^2 over the inliers [m^2]
  int matched = 0;                ///< points with a plane
  int inliers = 0;                ///< those inside the gate

  void add(const NormalEquations& other);

  /// Sets all 12 rows and columns from those of the IMU's pose.
  void spread(const PoseRows& rows);
};

/// Point-to-plane residuals z = n^T (R q + p - c) of points q in the IMU frame at the scan's end, weighted by
/// the inverse of their noise (residual_noise.h). The m points on one plane share its error, so each gets m times its
/// variance: together they tell no more than the plane itself knows.
class PointToPlane {
 public:
  explicit PointToPlane(TaskPool& pool) : pool_(pool) {}

  /// `uncertainty` is that of the points' pose and motion before the update. `last_epochs`, ascending, divide the
  /// planes into parts by their epochs, for information_of_parts().
  NormalEquations linearize(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                            const ScanUncertainty& uncertainty, const VoxelMap& map, const ResidualOptions& options,
                            const std::vector<std::uint32_t>& last_epochs = {});

  /// What each part of the planes adds to the information of the pose, in the last linearisation. Planes beyond the
  /// last epoch belong to the last part.
  const std::vector<PoseMatrix>& information_of_parts() const { return parts_; }

  /// What holds a direction up is so many things as its information squared over the sum of the squares of what each
  /// adds to it: that sum for each direction of `found`, in the last linearisation, of these points at this state. Each
  /// plane is such a thing. For a direction that mostly turns about the vertical all planes in one column (ColumnSums)
  /// are one together: those of a pillar or a door post, one above the other, err alike (decisions 22).
  PoseVector squares_along(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                           const Localizability& found);

  /// Covariance, by the noise of the planes' normals, of the information's product with `direction`, in the last
  /// linearisation, of these points at this state.
  PoseMatrix coupling_noise(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                            const PoseVector& direction) const;

 private:
  void match(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state, const VoxelMap& map,
             const OldPlanes& old_planes);
  void count_groups();
  /// Number of points on the i-th point's plane.
  double sharing(std::size_t i) const {
    return planes_[i]->group == Plane::kNoGroup ? 1.0 : shared_[planes_[i]->group];
  }

  TaskPool& pool_;
  std::vector<const Plane*> planes_;  ///< a point's plane or null
  std::vector<Plane> scratch_;
  std::vector<std::uint32_t> shared_;  ///< by group: points on that plane
  ColumnSums columns_;
  std::vector<double> weights_;  ///< of the points in the last linearisation; 0: not an inlier
  std::vector<NormalEquations> blocks_;
  std::vector<PoseMatrix> block_parts_;  ///< part by part for every block
  std::vector<PoseMatrix> parts_;
};

}  // namespace allan_lio
