// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace allan_lio {

/// The sphere S^2 of directions, carried by a vector of known length (gravity).
/// A perturbation d [rad, 2] turns x about the axis `basis(x) d`: x + d = Exp(basis(x) d) x.
/// (Hertzberg et al. 2013; He, Xu and Zhang 2021.)

/// 3 x 2, orthonormal columns perpendicular to x.
Eigen::Matrix<double, 3, 2> s2_basis(const Eigen::Vector3d& x);

Eigen::Vector3d s2_plus(const Eigen::Vector3d& x, const Eigen::Vector2d& d);

/// d such that s2_plus(x, d) has the direction of y; |d| in [0, pi).
Eigen::Vector2d s2_minus(const Eigen::Vector3d& y, const Eigen::Vector3d& x);

/// d s2_plus(x, d)/dd at d = 0, 3 x 2 [unit of x per rad].
Eigen::Matrix<double, 3, 2> s2_plus_jacobian(const Eigen::Vector3d& x);

/// d s2_minus(s2_plus(y, d), x)/dd at d = 0, 2 x 2.
Eigen::Matrix2d s2_minus_jacobian(const Eigen::Vector3d& y, const Eigen::Vector3d& x);

}  // namespace allan_lio
