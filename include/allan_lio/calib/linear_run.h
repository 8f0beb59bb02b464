// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

// Of the directions that a scan supports, six at most.
using SupportedRows = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 6, 6>;
using SupportedVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;
using SupportedMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

/// A scan of a run as an error x of the run's own states sees it, x = truth (-) state:
///   x = with_bias_means(phi) x_before - correction + w,   cov(w) = k_g^2 noise[0] + k_a^2 noise[1] + k_gb^2 noise[2] +
///   k_ab^2 noise[3]
///                                                 + bridged,
///   measured = rows (pose of x - what the measurement sees beside it) + v,   cov(v) = diag(variances).
struct LinearScan {
  double time = 0.0;  ///< since the run's first state [s]
  double step = 0.0;  ///< since the state before [s]
  NavMatrix phi = NavMatrix::Identity();
  std::array<NavMatrix, 4> noise;                      ///< with k = 1, in the order of k_g, k_a, k_gb, k_ab
  NavMatrix bridged = NavMatrix::Zero();               ///< for gaps, saturated readings, relocations, whatever the k
  InertialVector correction = InertialVector::Zero();  ///< the state (-) what the readings made of the state before

  // The registration; no rows if there was none.
  SupportedRows rows;         ///< from the pose's error to metres at the scene's scale, one a supported direction
  SupportedRows map_rows;     ///< the same from an error of the map: rotation in the world's axes
  SupportedVector measured;   ///< [m]
  SupportedVector variances;  ///< by the points' noise with the run's k_r [m^2]
  double log_gram = 0.0;      ///< what a log determinant over the rows has more in metres, as they are not orthogonal
  PoseMatrix view_noise = PoseMatrix::Zero();  ///< ScanMeasurement
  double view_kept = 1.0, deskewed = 0.0;      ///< ScanMeasurement
};

/// A run of the filter with its nonlinear parts frozen: where its states were, what the readings made of them and what
/// the scans told. Another noise is then judged by a linear Kalman filter on it, in milliseconds and smoothly, where a
/// run of its own would take seconds and jump with every plane that is matched or not. Some 15 kB a scan.
struct LinearRun {
  std::vector<LinearScan> scans;
  InertialMatrix initial_covariance = InertialMatrix::Zero();  ///< of the first state
  Eigen::Vector3d gyro_psd = Eigen::Vector3d::Zero();          ///< with k_g = 1 [(rad/s)^2/Hz]
  double k_r = 1.0;                                            ///< that the run had
};

/// Collects a run's states and makes the linear run of them.
class LinearRunRecorder {
 public:
  /// The states of a run, one after the other. The linear run begins where a standstill that was held ended.
  void add(const LioResult& result);

  /// `config` of the run, whose multipliers of the IMU play no part; `imu`: what it was given, in any order;
  /// `accel_scale`: factor from the readings to m/s^2. The noise is discretised by the trapezoid (paper,
  /// `Q_expectation`) where the configuration asks for Van Loan's exact integral, which is a hundred times dearer.
  LinearRun finish(const LioConfig& config, const std::vector<ImuSample>& imu, double accel_scale) const;

 private:
  std::vector<LioResult> results_;
};

}  // namespace allan_lio
