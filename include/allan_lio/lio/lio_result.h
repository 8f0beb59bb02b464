// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "allan_lio/imu/nav_state.h"
#include "allan_lio/lio/localizability.h"
#include "allan_lio/lio/pose_innovation.h"
#include "allan_lio/math/rigid_transform.h"

namespace allan_lio {

/// The estimator's error state: the inertial one, what its biases decay to, and the LiDAR's extrinsics (right
/// perturbation). A random walk has no mean; then it stays as it began, known, and moves nothing.
enum LioIndex : int {
  kGyroBiasMean = kNavDof,       ///< [rad/s], IMU frame
  kAccelBiasMean = kNavDof + 3,  ///< [m/s^2], IMU frame
  kInertialDof = kNavDof + 6,
  kExtrinsicRotation = kInertialDof,         ///< [rad], LiDAR frame
  kExtrinsicTranslation = kInertialDof + 3,  ///< [m], IMU frame
  kLioDof = kInertialDof + 6,
};
using InertialMatrix = Eigen::Matrix<double, kInertialDof, kInertialDof>;
using InertialVector = Eigen::Matrix<double, kInertialDof, 1>;
using LioMatrix = Eigen::Matrix<double, kLioDof, kLioDof>;
using LioVector = Eigen::Matrix<double, kLioDof, 1>;

struct LioState {
  NavState nav;
  RigidTransform T_imu_lidar;
};

/// What became of a scan.
enum class ScanOutcome {
  kUpdated,        ///< registered to the map and inserted
  kFirst,          ///< the first one: it founds the map
  kTooFewPoints,   ///< the IMU went on alone
  kTooFewMatches,  ///< the IMU went on alone
  kMapRestarted,   ///< too many scans in a row had no match, or the IMU was silent for too long: the map starts anew
};

/// A scan's registration as one measurement of the pose, as its last iteration had it.
struct ScanMeasurement {
  NavState at;                                  ///< where it was linearised
  PoseMatrix information = PoseMatrix::Zero();  ///< of the residuals, not weighed by the support [1/rad^2, 1/m^2]
  PoseVector gradient = PoseVector::Zero();     ///< the information times the pose's error about `at`
  PoseMatrix view_noise = PoseMatrix::Zero();   ///< covariance that ViewError went towards [rad^2, m^2]
  double view_kept = 1.0;                       ///< part of itself that ViewError kept since the scan before
  double deskewed = 0.0;                        ///< duration over which deskewing_error() counted [s]
};

/// The estimate at a scan's end.
struct LioResult {
  ScanOutcome outcome = ScanOutcome::kUpdated;
  TimeNs scan_begin = 0;
  LioState state;                                  ///< its stamp is the scan's end
  LioMatrix covariance = LioMatrix::Zero();        ///< of the error state, SI units of LioIndex
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();  ///< angular rate at the scan's end, bias off [rad/s], IMU frame
  bool standing = false;                           ///< at the start; the state was held there
  int points = 0;                                  ///< of the decoded scan
  int registered = 0;                              ///< after downsampling, lidar/max_registered at most
  int inliers = 0;                                 ///< with a plane and inside the gate, in the last iteration
  int iterations = 0;
  double residual_rms = 0.0;  ///< of the inliers, point to plane [m]
  /// Step of the pose (rotation in the IMU's frame [rad], translation in the world [m]) by which a run that had come
  /// back aside of its map was set right before the update (PlaceSearch); zero: it was not.
  PoseVector relocated = PoseVector::Zero();
  Localizability localizability;
  PoseInnovation
      innovation;  ///< of the scan against the prediction; 0 degrees of freedom without an update, or relocated
  ScanMeasurement measurement;  ///< of kUpdated
};

/// What was read and what was dropped, since the start.
struct LioCounters {
  std::uint64_t imu_read = 0;
  std::uint64_t imu_dropped_order = 0;    ///< stamp not later than the one before
  std::uint64_t imu_dropped_invalid = 0;  ///< NaN, inf, beyond 50 g or 100 rad/s
  std::uint64_t imu_saturated = 0;        ///< intervals with a saturated reading at an end
  std::uint64_t imu_gaps = 0;             ///< longer than 0.1 s, one a scan at most
  std::uint64_t scans_read = 0;
  std::uint64_t scans_used = 0;           ///< kUpdated, kFirst and kMapRestarted
  std::uint64_t map_restarts = 0;         ///< kMapRestarted
  std::uint64_t places_found = 0;         ///< the run had come back aside of its map and was set right (PlaceSearch)
  std::uint64_t starts_in_place = 0;      ///< after a silence of the IMU longer than imu/max_gap
  std::uint64_t scans_dropped_order = 0;  ///< older than the newest one taken
  std::uint64_t scans_before_imu = 0;     ///< begin before the first IMU sample
  std::uint64_t scans_after_imu = 0;      ///< end after the last IMU sample when the data ended
  std::uint64_t scans_too_few_points = 0;
  std::uint64_t scans_too_few_matches = 0;
  std::uint64_t scans_overflow = 0;  ///< waited for IMU data that did not come
  std::uint64_t points_invalid = 0;
  std::uint64_t points_out_of_range = 0;
  std::uint64_t points_over_budget = 0;  ///< left out of the registration for lidar/max_registered
};

}  // namespace allan_lio
