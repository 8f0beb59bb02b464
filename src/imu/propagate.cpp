// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/propagate.h"

#include <cmath>

#include "allan_lio/math/so3.h"

namespace allan_lio {

ImuInterval mean_interval(const NavState& state, const ImuSample& from, const ImuSample& to) {
  ImuInterval interval;
  interval.dt = seconds_between(from.stamp, to.stamp);
  interval.gyro = 0.5 * (from.gyro + to.gyro) - state.gyro_bias;
  interval.accel = 0.5 * (from.accel + to.accel) - state.accel_bias;
  return interval;
}

NavState propagate_mean(const NavState& state, const ImuInterval& interval, const ImuNoise& noise) {
  const double dt = interval.dt;
  const Eigen::Vector3d phi = interval.gyro * dt;
  const Eigen::Quaterniond& rotation = state.T_world_imu.rotation;
  NavState next = state;
  next.stamp += to_ns(dt);
  next.T_world_imu.rotation = (rotation * exp_so3(phi)).normalized();
  next.velocity_world += dt * (state.gravity_world + rotation * (gamma_so3(1, phi) * interval.accel));
  next.T_world_imu.translation +=
      dt * state.velocity_world +
      dt * dt * (0.5 * state.gravity_world + rotation * (gamma_so3(2, phi) * interval.accel));
  const auto decay = [dt](const Eigen::Vector3d& rate, const Eigen::Vector3d& mean, Eigen::Vector3d& bias) {
    bias.array() += (-dt * rate.array()).unaryExpr([](double x) { return std::expm1(x); }) * (bias - mean).array();
  };
  decay(noise.gyro_bias_rate, state.gyro_bias_mean, next.gyro_bias);
  decay(noise.accel_bias_rate, state.accel_bias_mean, next.accel_bias);
  return next;
}

}  // namespace allan_lio
