// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/math/time.h"

namespace allan_lio {

/// Order of the error state delta = x (-) x_hat (right perturbation of the rotation, theory section 2).
enum NavIndex : int {
  kTheta = 0,       ///< R = R_hat Exp(dtheta) [rad], in the IMU frame
  kPosition = 3,    ///< [m], world
  kVelocity = 6,    ///< [m/s], world
  kGyroBias = 9,    ///< [rad/s], IMU frame
  kAccelBias = 12,  ///< [m/s^2], IMU frame
  kGravity = 15,    ///< [rad], 2 entries, tangent to the sphere of gravity directions
  kNavDof = 17,
};
using NavVector = Eigen::Matrix<double, kNavDof, 1>;
using NavMatrix = Eigen::Matrix<double, kNavDof, kNavDof>;

/// The inertial state that every estimator on this core shares.
struct NavState {
  TimeNs stamp = 0;
  RigidTransform T_world_imu;                                ///< [m]
  Eigen::Vector3d velocity_world = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();       ///< [rad/s]
  Eigen::Vector3d accel_bias = Eigen::Vector3d::Zero();      ///< [m/s^2]
  /// What a Gauss-Markov bias decays to: its constant part, as it was at switch-on. No part of the error state here.
  Eigen::Vector3d gyro_bias_mean = Eigen::Vector3d::Zero();   ///< [rad/s]
  Eigen::Vector3d accel_bias_mean = Eigen::Vector3d::Zero();  ///< [m/s^2]
  Eigen::Vector3d gravity_world{0.0, 0.0, -9.80665};          ///< [m/s^2], its length never changes
};

/// x (+) delta.
NavState nav_plus(const NavState& x, const NavVector& delta);

/// delta such that nav_plus(x, delta) = y.
NavVector nav_minus(const NavState& y, const NavState& x);

/// d nav_minus(nav_plus(y, d), x)/dd at d = 0.
NavMatrix nav_minus_jacobian(const NavState& y, const NavState& x);

}  // namespace allan_lio
