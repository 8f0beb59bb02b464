// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/nav_state.h"

namespace allan_lio {

/// How the continuous noise S becomes the discrete Q of one IMU interval (theory section 2).
enum class Discretization {
  kEuler,      ///< G S G^T dt (paper, `continuous_q`)
  kTrapezoid,  ///< [Phi G S G^T Phi^T + G S G^T] dt / 2 (paper, `Q_expectation`)
  kDiscrete,   ///< G (S/dt) G^T dt^2 (paper, `Q2` with `Qk_with_S`): FAST-LIO2's form
  kVanLoan,    ///< the exact integral for constant rate and specific force (Van Loan 1978)
};

/// The means over one interval, biases taken off.
struct ImuInterval {
  double dt = 0.0;                                  ///< [s]
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();   ///< angular rate [rad/s]
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();  ///< specific force [m/s^2]
};

/// delta_k = phi delta_{k-1} + w, w ~ N(0, q).
struct DiscreteModel {
  NavMatrix phi;
  NavMatrix q;
};

/// Phi and Q of the error state over `interval`, starting from `start` (its rotation and gravity are used).
/// Phi is exact for constant rate and specific force but for the decay of a Gauss-Markov bias inside the
/// interval, of which it neglects the second order in dt/T.
DiscreteModel discretize(const NavState& start, const ImuInterval& interval, const ImuNoise& noise,
                         Discretization method);

}  // namespace allan_lio
