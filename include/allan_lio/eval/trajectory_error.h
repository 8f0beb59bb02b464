// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "allan_lio/io/tum.h"

namespace allan_lio {

/// How the estimate is laid over the reference before the absolute error is taken.
enum class Alignment {
  kSe3,    ///< rotation and translation that fit all positions best (Umeyama 1991, without scale)
  kYaw,    ///< translation and heading that fit all positions best: for two gravity-aligned worlds
  kStart,  ///< the first poses coincide
  kNone,   ///< as they are
};

/// Root mean square, mean, median and maximum of the magnitudes of errors.
struct ErrorStatistics {
  double rmse = 0.0, mean = 0.0, median = 0.0, max = 0.0;
};

/// Error of the motion between two poses that lie `delta` apart, over all such pairs (Sturm et al. 2012).
struct RelativeError {
  std::size_t pairs = 0;          ///< 0: the trajectory is too short, and the rest has no meaning
  double translation_rmse = 0.0;  ///< [m]
  /// rms translation error over the rms path between the two poses, so that standstills don't blow it up [%].
  /// NaN where no path was travelled.
  double translation_percent = 0.0;
  double rotation_rmse = 0.0;  ///< [rad]
};

/// Aligned estimate against the reference at one stamp.
struct PoseError {
  TimeNs stamp = 0;
  RigidTransform reference;                               ///< interpolated
  RigidTransform estimate;                                ///< aligned
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< estimate - reference, in the reference's world [m]
  double rotation = 0.0;                                  ///< angle between the two [rad]
};

struct TrajectoryError {
  Alignment alignment = Alignment::kSe3;
  RigidTransform T_reference_estimate;  ///< takes the estimate's world to the reference's
  std::size_t matched = 0;
  std::size_t unmatched = 0;    ///< poses of the estimate outside the reference's span or in one of its gaps
  double duration = 0.0;        ///< between the first and the last matched pose [s]
  double path_length = 0.0;     ///< of the reference through the matched poses [m]
  ErrorStatistics translation;  ///< absolute trajectory error [m]
  ErrorStatistics rotation;     ///< [rad]
  RelativeError over_1s, over_10m;
  /// Position error of the last matched pose as seen from the first: does not depend on the alignment [m].
  double end_drift = 0.0;
  double end_drift_percent = 0.0;  ///< of path_length [%]; NaN where the path has no length
  std::vector<PoseError> errors;   ///< one a matched pose
};

/// The reference is interpolated (position linearly, rotation by slerp) at the stamps of the estimate, between
/// neighbours at most `max_gap` [s] apart. Throws std::runtime_error with a sentence if nothing matches or if the
/// matched positions do not determine the alignment.
TrajectoryError evaluate_trajectory(const Trajectory& reference, const Trajectory& estimate, Alignment alignment,
                                    double max_gap = 0.5);

}  // namespace allan_lio
