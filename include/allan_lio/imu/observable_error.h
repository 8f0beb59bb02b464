// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/imu/nav_state.h"

namespace allan_lio {

// What an estimate errs by whoever defines the world: the heading and the position of an odometry drift with its map,
// and a velocity along the world's axes drifts with the heading; these don't. `truth` may be in another world.

/// Roll and pitch: the true direction of gravity as the IMU sees it, turned to the estimate's world by the estimated
/// attitude, against the estimated direction there, s2_minus(R_hat R^T g, g_hat) [rad, tangent at g_hat]. To first
/// order it is d_gravity - B^T R_hat dtheta, B = s2_basis(g_hat): an attitude and a gravity that err alike make no
/// tilt.
Eigen::Vector2d tilt_error(const NavState& estimate, const NavState& truth);

/// Covariance of that error [rad^2].
Eigen::Matrix2d tilt_covariance(const NavState& estimate, const NavMatrix& covariance);

/// Velocity along the IMU's axes, R^T v - R_hat^T v_hat [m/s]; to first order R_hat^T dv + (R_hat^T v_hat) x dtheta.
Eigen::Vector3d imu_velocity_error(const NavState& estimate, const NavState& truth);

/// Covariance of that error [(m/s)^2].
Eigen::Matrix3d imu_velocity_covariance(const NavState& estimate, const NavMatrix& covariance);

}  // namespace allan_lio
