// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "posterior_covariance.h"

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

// 1 sigma of a motion that a scan does not see, per unit of its column: far more than can happen between two scans.
constexpr double kUnseen = 100.0;

}  // namespace

PosteriorCovariance::PosteriorCovariance(const BoundOptions& options)
    : position_sigma_(options.position_sigma),
      rotation_sigma_(options.rotation_sigma),
      standing_sigma_(options.standing_sigma) {
  p_.diagonal().segment<3>(kVelocity).setConstant(options.velocity_sigma * options.velocity_sigma);
  p_.diagonal().segment<3>(kGyroBias) = options.gyro_bias_sigma.cwiseAbs2();
  p_.diagonal().segment<3>(kAccelBias) = options.accel_bias_sigma.cwiseAbs2();
  p_.diagonal().segment<2>(kGravity).setConstant(options.gravity_sigma * options.gravity_sigma);
}

void PosteriorCovariance::propagate(const DiscreteModel& model, const Eigen::Vector3d& moved) {
  Matrix phi = Matrix::Identity();
  phi.topLeftCorner<kNavDof, kNavDof>() = model.phi;
  phi.block<3, 3>(kMapShift, kMapTurn) = -skew(moved);  // the map is rigid: turn x moved
  p_ = phi * p_ * phi.transpose();
  p_.topLeftCorner<kNavDof, kNavDof>() += model.q;
}

void PosteriorCovariance::measure(const Eigen::Matrix3d& rotation, const BodyMotions& unseen) {
  p_.bottomRightCorner<6, 6>() += kUnseen * kUnseen * unseen * unseen.transpose();
  Eigen::Matrix<double, 6, kDof> rows = Eigen::Matrix<double, 6, kDof>::Zero();
  rows.block<3, 3>(0, kTheta) = rotation;
  rows.block<3, 3>(3, kPosition).setIdentity();
  rows.rightCols<6>() = -Eigen::Matrix<double, 6, 6>::Identity();
  for (int i = 0; i < 6; ++i)  // independent of each other: one after the other
    observe(rows.row(i).transpose(), i < 3 ? rotation_sigma_ : position_sigma_);
}

void PosteriorCovariance::stand() {
  for (int i = 0; i < 3; ++i) observe(Eigen::Matrix<double, kDof, 1>::Unit(kVelocity + i), standing_sigma_);
}

void PosteriorCovariance::observe(const Eigen::Matrix<double, kDof, 1>& row, double sigma) {
  const Eigen::Matrix<double, kDof, 1> seen = p_ * row;
  p_ -= seen * seen.transpose() / (row.dot(seen) + sigma * sigma);
}

void PosteriorCovariance::anchor_position() {
  Matrix shift = Matrix::Identity();
  shift.block<3, 3>(kPosition, kPosition).setZero();
  shift.block<3, 3>(kMapShift, kPosition) = -Eigen::Matrix3d::Identity();
  p_ = shift * p_ * shift.transpose();
}

void PosteriorCovariance::anchor_heading(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& velocity_world) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Eigen::RowVector3d heading = z.transpose() * rotation;
  Matrix turn = Matrix::Identity();
  turn.block<3, 3>(kTheta, kTheta) -= heading.transpose() * heading;
  turn.block<3, 3>(kVelocity, kTheta) = -z.cross(velocity_world) * heading;
  turn.block<3, 3>(kMapTurn, kTheta) = -z * heading;  // about the body, whose displacements stay
  p_ = turn * p_ * turn.transpose();
}

}  // namespace allan_lio
