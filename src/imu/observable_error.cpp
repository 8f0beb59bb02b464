// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/observable_error.h"

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

Eigen::Vector3d imu_velocity(const NavState& state) {
  return state.T_world_imu.rotation.conjugate() * state.velocity_world;
}

}  // namespace

Eigen::Vector2d tilt_error(const NavState& estimate, const NavState& truth) {
  const Eigen::Vector3d seen = truth.T_world_imu.rotation.conjugate() * truth.gravity_world;
  return s2_minus(estimate.T_world_imu.rotation * seen, estimate.gravity_world);
}

Eigen::Matrix2d tilt_covariance(const NavState& estimate, const NavMatrix& covariance) {
  Eigen::Matrix<double, 2, kNavDof> jacobian = Eigen::Matrix<double, 2, kNavDof>::Zero();
  jacobian.block<2, 3>(0, kTheta) =
      -s2_basis(estimate.gravity_world).transpose() * estimate.T_world_imu.rotation.toRotationMatrix();
  jacobian.block<2, 2>(0, kGravity).setIdentity();
  return jacobian * covariance * jacobian.transpose();
}

Eigen::Vector3d imu_velocity_error(const NavState& estimate, const NavState& truth) {
  return imu_velocity(truth) - imu_velocity(estimate);
}

Eigen::Matrix3d imu_velocity_covariance(const NavState& estimate, const NavMatrix& covariance) {
  Eigen::Matrix<double, 3, kNavDof> jacobian = Eigen::Matrix<double, 3, kNavDof>::Zero();
  jacobian.block<3, 3>(0, kTheta) = skew(imu_velocity(estimate));
  jacobian.block<3, 3>(0, kVelocity) = estimate.T_world_imu.rotation.conjugate().toRotationMatrix();
  return jacobian * covariance * jacobian.transpose();
}

}  // namespace allan_lio
