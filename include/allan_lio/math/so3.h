// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace allan_lio {

/// Cross-product matrix: `skew(a) * b = a x b`.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Exp: rotation vector [rad] to rotation. Exact for every angle, smooth at zero.
Eigen::Quaterniond exp_so3(const Eigen::Vector3d& phi);

/// Log: rotation to rotation vector [rad], norm in [0, pi].
Eigen::Vector3d log_so3(const Eigen::Quaterniond& q);

/// Right Jacobian: `Exp(phi + d) = Exp(phi) Exp(right_jacobian(phi) d)` to first order in d.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi);
Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& phi);

/// C_k(theta) = sum_j (-1)^j theta^(2j) / (2j+k)!, k >= 0: sin(theta)/theta is C_1,
/// (1-cos(theta))/theta^2 is C_2, and so on. Smooth at zero.
double gamma_coefficient(int k, double theta);

/// Gamma_m(phi) = sum_n skew(phi)^n / (n+m)!: the m-fold integral of Exp along a constant rotation rate.
/// Gamma_0 = Exp, Gamma_1 = left Jacobian; with phi = omega*dt a constant body acceleration a gives
/// dv = R Gamma_1 a dt, dp = R Gamma_2 a dt^2 (Bloesch et al. 2012; Hartley et al. 2020, eq. 79).
Eigen::Matrix3d gamma_so3(int m, const Eigen::Vector3d& phi);

/// d(Gamma_m(phi) a)/d(phi), 3 x 3.
Eigen::Matrix3d gamma_so3_derivative(int m, const Eigen::Vector3d& phi, const Eigen::Vector3d& a);

}  // namespace allan_lio
