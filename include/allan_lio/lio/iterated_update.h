// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "allan_lio/lio/absolute_covariance.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"
#include "allan_lio/lio/place_search.h"
#include "allan_lio/lio/point_to_plane.h"
#include "allan_lio/lio/pose_innovation.h"
#include "allan_lio/lio/update_step.h"

namespace allan_lio {

ResidualOptions residual_options(const LioConfig& config);

struct UpdateReport {
  bool applied = false;  ///< false: too few matches, state and covariance are as they were
  int iterations = 0;
  int inliers = 0;
  double residual_rms = 0.0;  ///< [m]
  Localizability localizability;
  PoseInnovation innovation;  ///< at the prediction
  ScanMeasurement measurement;
  bool relocated = false;  ///< the update has ended at the place where it began (ScanConditions)
};

struct ScanConditions {
  double since_update;    ///< since the last update [s]
  double deskewed = 0.0;  ///< the scan's duration if it was deskewed with the predicted motion [s]
  Eigen::Vector3d gyro_psd = Eigen::Vector3d::Zero();  ///< of the IMU that deskewed it [(rad/s)^2/Hz]
  /// Where the scan was found to fit: the update begins there, and there is no innovation.
  std::optional<Place> place = std::nullopt;
};

/// Registers the points (IMU frame at the scan's end, by the state's extrinsics) to the map: moves state, belief and
/// absolute covariance to the posterior.
UpdateReport iterated_update(const std::vector<Eigen::Vector3f>& points_imu, const VoxelMap& map,
                             const LioConfig& config, const ScanConditions& conditions, PointToPlane& residuals,
                             LioState& state, Belief& belief, AbsoluteCovariance& absolute);

}  // namespace allan_lio
