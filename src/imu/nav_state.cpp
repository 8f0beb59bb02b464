// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/nav_state.h"

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {

NavState nav_plus(const NavState& x, const NavVector& delta) {
  NavState y = x;
  y.T_world_imu.rotation = (x.T_world_imu.rotation * exp_so3(delta.segment<3>(kTheta))).normalized();
  y.T_world_imu.translation += delta.segment<3>(kPosition);
  y.velocity_world += delta.segment<3>(kVelocity);
  y.gyro_bias += delta.segment<3>(kGyroBias);
  y.accel_bias += delta.segment<3>(kAccelBias);
  y.gravity_world = s2_plus(x.gravity_world, delta.segment<2>(kGravity));
  return y;
}

NavVector nav_minus(const NavState& y, const NavState& x) {
  NavVector delta;
  delta.segment<3>(kTheta) = log_so3(x.T_world_imu.rotation.conjugate() * y.T_world_imu.rotation);
  delta.segment<3>(kPosition) = y.T_world_imu.translation - x.T_world_imu.translation;
  delta.segment<3>(kVelocity) = y.velocity_world - x.velocity_world;
  delta.segment<3>(kGyroBias) = y.gyro_bias - x.gyro_bias;
  delta.segment<3>(kAccelBias) = y.accel_bias - x.accel_bias;
  delta.segment<2>(kGravity) = s2_minus(y.gravity_world, x.gravity_world);
  return delta;
}

NavMatrix nav_minus_jacobian(const NavState& y, const NavState& x) {
  NavMatrix jacobian = NavMatrix::Identity();
  const Eigen::Vector3d theta = log_so3(x.T_world_imu.rotation.conjugate() * y.T_world_imu.rotation);
  jacobian.block<3, 3>(kTheta, kTheta) = right_jacobian_inverse(theta);
  jacobian.block<2, 2>(kGravity, kGravity) = s2_minus_jacobian(y.gravity_world, x.gravity_world);
  return jacobian;
}

}  // namespace allan_lio
