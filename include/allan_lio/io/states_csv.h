// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "allan_lio/imu/nav_state.h"

namespace allan_lio {

/// One scan's line of a run's states.csv. Covariances are of the error state of NavIndex.
struct StateRow {
  NavState nav;
  Eigen::Matrix3d cov_theta, cov_position, cov_gyro_bias, cov_accel_bias;
  Eigen::Matrix2d cov_tilt;          ///< of tilt_error() [rad^2]
  Eigen::Matrix3d cov_imu_velocity;  ///< of imu_velocity_error() [(m/s)^2]
  double weakest_support = 1.0;
  /// Of the pose-equivalent innovation, NaN where a scan had no update: its normalised square, how many degrees of
  /// freedom that has, and the innovation itself, whitened (unit covariance if the filter is honest).
  double nis = 0.0, nis_dof = 0.0;
  Eigen::Matrix<double, 6, 1> innovation = Eigen::Matrix<double, 6, 1>::Zero();
};

struct StateRecord {
  std::vector<StateRow> rows;
  bool has_innovation = false;  ///< columns nis, nis_dof, innovation_0 .. innovation_5
};

/// Reads what RunWriter writes. Throws std::runtime_error "file:line: sentence", and names the column that a file of
/// an older version lacks.
StateRecord read_states_csv(const std::string& path);

/// What the truth knows besides the pose, in the truth's world.
struct TruthState {
  TimeNs stamp = 0;
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();       ///< [rad/s], IMU frame
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();      ///< [m/s^2], IMU frame
};

/// Columns t, v_x .. v_z, bg_x .. bg_z, ba_x .. ba_z. Mistakes as above.
std::vector<TruthState> read_truth_csv(const std::string& path);
void write_truth_csv(const std::string& path, const std::vector<TruthState>& truth);

}  // namespace allan_lio
