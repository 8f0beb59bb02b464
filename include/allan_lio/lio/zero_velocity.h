// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "allan_lio/lio/point_to_plane.h"

namespace allan_lio {

/// True if the points (IMU frame at the scan's end) lie on the map's planes as they would without any motion since
/// the map was founded at `start`. With a quiet IMU that is a standstill; the IMU alone cannot tell it from a steady
/// ride.
bool agrees_with_standstill(const std::vector<Eigen::Vector3f>& points_imu, const LioState& start, const VoxelMap& map,
                            const ResidualOptions& options, PointToPlane& residuals);

/// Kalman update with the measurement "velocity is zero", 1 sigma `sigma` [m/s] on each axis.
void update_zero_velocity(double sigma, LioState& state, LioMatrix& covariance);

}  // namespace allan_lio
