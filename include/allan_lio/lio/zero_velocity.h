// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "allan_lio/lio/point_to_plane.h"

namespace allan_lio {

/// True if a scan that was taken with a quiet IMU shows motion all the same (a steady ride): of the points for which
/// the map has a plane too few lie on it from the `start`'s pose. A map that has hardly a plane yet contradicts
/// nothing: on flat ground the first sweeps are mere rings.
bool contradicts_standstill(const std::vector<Eigen::Vector3f>& points_imu, const LioState& start, const VoxelMap& map,
                            const ResidualOptions& options, PointToPlane& residuals);

/// Kalman update with the measurement "velocity is zero", 1 sigma `sigma` [m/s] on each axis.
void update_zero_velocity(double sigma, LioState& state, LioMatrix& covariance);

}  // namespace allan_lio
