// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/io/states_csv.h"
#include "allan_lio/io/tum.h"

namespace allan_lio {

/// Is the filter as sure as it may be? NEES = (x - x_hat)^T P^-1 (x - x_hat) of one block of the state.
///
/// Tilt, velocity (along the IMU's axes) and biases don't depend on the world's choice. For the position the truth's
/// world is laid over the estimate's so that the first poses coincide, in all six degrees of freedom: that is how the
/// estimator's world is defined (doc/frames.md), and what is not known of its tilt stands in the direction of gravity.
/// It drifts with the map, so its NEES says how far that goes rather than pass or fail. The truth's world must be
/// level.
enum class NeesBlock : int {
  kTilt,              ///< 2: tilt_error()
  kVelocity,          ///< 3: imu_velocity_error()
  kGyroBias,          ///< 3, where the truth of the biases is known
  kAccelBias,         ///< 3, likewise
  kAlong,             ///< 1: position along the axis
  kAcross,            ///< 2: position across it
  kRelativePosition,  ///< 3: from a scan to the first that lies 10 m of path ahead, in the IMU frame of the former
  kRelativeRotation,  ///< 3
  kInnovation,        ///< up to 6: the normalised innovation squared (NIS), where the run recorded it
};
constexpr int kNeesBlocks = 9;

/// "tilt", "velocity", ...
const char* nees_block_name(NeesBlock block);

/// Along what the axial error is taken.
enum class AxisKind {
  kPath,     ///< the horizontal direction in which the true path extends most
  kMotion,   ///< where the truth moves at the time (the last direction while it stands)
  kWeakest,  ///< where the filter is least sure of the position at the time
  kGiven,    ///< a direction in the truth's world
};
struct AxisChoice {
  AxisKind kind = AxisKind::kPath;
  Eigen::Vector3d given = Eigen::Vector3d::UnitX();
};

/// Speed from which a direction of motion is one [m/s].
constexpr double kMovingSpeed = 0.1;

/// Horizontal direction in which the positions extend most, of unit length.
Eigen::Vector3d main_axis(const Trajectory& poses);

/// "path", "motion", "weakest" or three numbers "1,0,0". Throws std::invalid_argument quoting anything else.
AxisChoice parse_axis(const std::string& text);

/// One scan. NaN where something is not known or has no meaning.
struct ConsistencySample {
  TimeNs stamp = 0;
  std::array<double, kNeesBlocks> nees;  ///< chi^2 of as many degrees of freedom as `dof` if the filter is honest
  std::array<double, kNeesBlocks> dof;
  Eigen::Vector2d tilt, sigma_tilt;              ///< errors, true minus estimate, and 1 sigma [rad]
  Eigen::Vector3d velocity, sigma_velocity;      ///< [m/s], along the IMU's axes
  Eigen::Vector3d gyro_bias, sigma_gyro_bias;    ///< [rad/s]
  Eigen::Vector3d accel_bias, sigma_accel_bias;  ///< [m/s^2]
  double along = 0.0, sigma_along = 0.0;         ///< [m]
  Eigen::Vector2d across, sigma_across;          ///< [m]
  double support = 1.0;                          ///< of the scan's weakest direction
  Eigen::Matrix<double, 6, 1> innovation;        ///< whitened
};
using ConsistencySeries = std::vector<ConsistencySample>;

struct ConsistencyOptions {
  AxisChoice axis;
  double max_gap = 0.5;  ///< longest gap of the truth that is interpolated over [s]
};

/// `truth_states` may be empty: the velocity is then differentiated from the positions, and the biases stay unknown.
///
/// The covariance of a relative pose is not in the file, which has no correlation between two times. It is taken as
/// P_i + P_j with the lever of the rotation at i, as if the two errors were independent. Errors of odometry are
/// positively correlated, so this is an upper bound, and the NEES a lower one: above its band it proves that the filter
/// is too sure, below it proves nothing.
///
/// Throws std::runtime_error with a sentence if nothing matches.
ConsistencySeries consistency_series(const Trajectory& truth, const std::vector<TruthState>& truth_states,
                                     const StateRecord& states, const ConsistencyOptions& options);

/// Mean NEES over runs and time, per degree of freedom: 1 is honest, above is too sure.
struct NeesSummary {
  NeesBlock block = NeesBlock::kTilt;
  std::size_t samples = 0;  ///< 0: not known, and the rest has no meaning
  double mean = 0.0;
  /// 95 % chi^2 band of the mean over the runs at one time, per degree of freedom. NEES is correlated in time, so the
  /// mean over time lies inside with 95 % or more.
  double low = 0.0, high = 0.0;
  double inside = 0.0;  ///< share of the times at which the mean over the runs lies in its band
};

/// What could be known of the error that a stretch gains, 1 sigma [m]; NaN where it is not told.
struct StretchBound {
  double ideal = 0.0;       ///< by an ideal filter: posterior_bounds()
  double known_tilt = 0.0;  ///< by dead reckoning with known tilt, for an axis: portal_to_portal_sigma()
};

/// From the last scan before a stretch without support in some direction to the scan in it at which the filter is least
/// sure along the axis: there the support begins to return.
struct BlindStretch {
  TimeNs begin = 0, end = 0;
  double seconds = 0.0;
  double error = 0.0;  ///< gained along the axis from begin to end [m]
  double sigma = 0.0;  ///< the filter's own figure of it: sqrt(P_end - P_begin) along the axis [m]
  std::optional<StretchBound> bound = std::nullopt;  ///< where it was asked for: add_bounds()
};

/// Do the whitened innovations look white? For the components of the pose, in the order of the columns.
struct Whiteness {
  std::size_t samples = 0;                    ///< 0: not recorded
  std::array<double, 6> mean{}, deviation{};  ///< 0 and 1 if honest
  std::array<double, 6> correlation{};        ///< from one scan to the next
  double band = 0.0;                          ///< 95 % of the correlations of white noise lie within +- this
};

struct ConsistencySummary {
  std::size_t runs = 0, times = 0;
  std::array<NeesSummary, kNeesBlocks> nees;
  double three_sigma_share = 0.0;   ///< of the scans of all runs whose along-axis 3 sigma holds the error; NaN if none
  std::vector<BlindStretch> blind;  ///< of a single run
  Whiteness whiteness;              ///< of a single run
};

/// Over one run, or over several of one sequence with different seeds, whose scans must bear the same stamps (times
/// that some run lacks are left out). Throws std::runtime_error if they have no time in common.
ConsistencySummary summarize_consistency(const std::vector<ConsistencySeries>& runs);

}  // namespace allan_lio
