// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/discretize.h"

#include <unsupported/Eigen/MatrixFunctions>

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr int kNoiseDof = 12;
using NoiseMatrix = Eigen::Matrix<double, kNavDof, kNoiseDof>;

/// Phi for constant body rate and specific force, by the integrals Gamma_m and their derivatives.
NavMatrix transition(const NavState& start, const ImuInterval& interval, const ImuNoise& noise) {
  const double dt = interval.dt;
  const Eigen::Vector3d turn = interval.gyro * dt;
  const Eigen::Matrix3d rotation = start.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix3d gamma1 = gamma_so3(1, turn), gamma2 = gamma_so3(2, turn);
  const Eigen::Matrix<double, 3, 2> gravity_jacobian = s2_plus_jacobian(start.gravity_world);

  NavMatrix phi = NavMatrix::Identity();
  phi.block<3, 3>(kTheta, kTheta) = exp_so3(-turn).toRotationMatrix();
  phi.block<3, 3>(kTheta, kGyroBias) = -dt * right_jacobian(turn);
  phi.block<3, 3>(kPosition, kTheta) = -dt * dt * rotation * skew(gamma2 * interval.accel);
  phi.block<3, 3>(kPosition, kVelocity) = dt * Eigen::Matrix3d::Identity();
  phi.block<3, 3>(kPosition, kGyroBias) = -dt * dt * dt * rotation * gamma_so3_derivative(2, turn, interval.accel);
  phi.block<3, 3>(kPosition, kAccelBias) = -dt * dt * rotation * gamma2;
  phi.block<3, 2>(kPosition, kGravity) = 0.5 * dt * dt * gravity_jacobian;
  phi.block<3, 3>(kVelocity, kTheta) = -dt * rotation * skew(gamma1 * interval.accel);
  phi.block<3, 3>(kVelocity, kGyroBias) = -dt * dt * rotation * gamma_so3_derivative(1, turn, interval.accel);
  phi.block<3, 3>(kVelocity, kAccelBias) = -dt * rotation * gamma1;
  phi.block<3, 2>(kVelocity, kGravity) = dt * gravity_jacobian;
  phi.diagonal().segment<3>(kGyroBias) = (-dt * noise.gyro_bias_rate).array().exp();
  phi.diagonal().segment<3>(kAccelBias) = (-dt * noise.accel_bias_rate).array().exp();
  return phi;
}

/// G: where the noises of gyro, accelerometer and the two biases enter.
NoiseMatrix noise_input(const Eigen::Matrix3d& rotation) {
  NoiseMatrix g = NoiseMatrix::Zero();
  g.block<3, 3>(kTheta, 0) = -Eigen::Matrix3d::Identity();
  g.block<3, 3>(kVelocity, 3) = -rotation;
  g.block<3, 3>(kGyroBias, 6) = Eigen::Matrix3d::Identity();
  g.block<3, 3>(kAccelBias, 9) = Eigen::Matrix3d::Identity();
  return g;
}

/// Phi and Q by the matrix exponential of [-F, G S G^T; 0, F^T] dt. With velocity and position error turned
/// into the IMU frame, F and G are constant while rate and specific force are.
DiscreteModel van_loan(const NavState& start, const ImuInterval& interval, const ImuNoise& noise) {
  const Eigen::Matrix3d rate = skew(interval.gyro);
  NavMatrix f = NavMatrix::Zero();
  f.block<3, 3>(kTheta, kTheta) = -rate;
  f.block<3, 3>(kTheta, kGyroBias) = -Eigen::Matrix3d::Identity();
  f.block<3, 3>(kPosition, kPosition) = -rate;
  f.block<3, 3>(kPosition, kVelocity) = Eigen::Matrix3d::Identity();
  f.block<3, 3>(kVelocity, kTheta) = -skew(interval.accel);
  f.block<3, 3>(kVelocity, kVelocity) = -rate;
  f.block<3, 3>(kVelocity, kAccelBias) = -Eigen::Matrix3d::Identity();
  f.diagonal().segment<3>(kGyroBias) = -noise.gyro_bias_rate;
  f.diagonal().segment<3>(kAccelBias) = -noise.accel_bias_rate;
  const NoiseMatrix g = noise_input(Eigen::Matrix3d::Identity());

  Eigen::Matrix<double, 2 * kNavDof, 2 * kNavDof> block;
  block.setZero();
  block.topLeftCorner<kNavDof, kNavDof>() = -f * interval.dt;
  block.topRightCorner<kNavDof, kNavDof>() = g * noise.spectral_density().asDiagonal() * g.transpose() * interval.dt;
  block.bottomRightCorner<kNavDof, kNavDof>() = f.transpose() * interval.dt;
  const Eigen::MatrixXd exponential = Eigen::MatrixXd(block).exp();
  const NavMatrix phi_body = exponential.bottomRightCorner(kNavDof, kNavDof).transpose();
  const NavMatrix q_body = phi_body * exponential.topRightCorner(kNavDof, kNavDof);

  // Back to the world frame: delta_world = turn(t) delta_body. Gravity acts through the closed form.
  const Eigen::Matrix3d r0 = start.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix3d r1 = r0 * exp_so3(interval.gyro * interval.dt).toRotationMatrix();
  NavMatrix turn0 = NavMatrix::Identity(), turn1 = NavMatrix::Identity();
  for (const int i : {kPosition, kVelocity}) {
    turn0.block<3, 3>(i, i) = r0;
    turn1.block<3, 3>(i, i) = r1;
  }
  DiscreteModel model;
  model.phi = turn1 * phi_body * turn0.transpose();
  const Eigen::Matrix<double, 3, 2> gravity_jacobian = s2_plus_jacobian(start.gravity_world);
  model.phi.block<3, 2>(kPosition, kGravity) = 0.5 * interval.dt * interval.dt * gravity_jacobian;
  model.phi.block<3, 2>(kVelocity, kGravity) = interval.dt * gravity_jacobian;
  model.q = turn1 * (0.5 * (q_body + q_body.transpose())) * turn1.transpose();
  return model;
}

}  // namespace

DiscreteModel discretize(const NavState& start, const ImuInterval& interval, const ImuNoise& noise,
                         Discretization method) {
  if (method == Discretization::kVanLoan) return van_loan(start, interval, noise);

  const double dt = interval.dt;
  const Eigen::Matrix3d r0 = start.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix<double, kNoiseDof, 1> s = noise.spectral_density();
  const NoiseMatrix g0 = noise_input(r0);
  DiscreteModel model;
  model.phi = transition(start, interval, noise);
  if (method == Discretization::kEuler) {
    model.q = g0 * s.asDiagonal() * g0.transpose() * dt;
  } else if (method == Discretization::kDiscrete) {
    const Eigen::Matrix<double, kNoiseDof, 1> per_sample = s / dt;
    model.q = g0 * per_sample.asDiagonal() * g0.transpose() * (dt * dt);
  } else {
    const NoiseMatrix carried = model.phi * g0;
    const NoiseMatrix g1 = noise_input(r0 * exp_so3(interval.gyro * dt).toRotationMatrix());
    model.q = (0.5 * dt) * (carried * s.asDiagonal() * carried.transpose() + g1 * s.asDiagonal() * g1.transpose());
  }
  return model;
}

}  // namespace allan_lio
