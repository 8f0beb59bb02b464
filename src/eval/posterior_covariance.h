// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/eval/posterior_bound.h"
#include "allan_lio/imu/discretize.h"

namespace allan_lio {

/// Small motions of the body in the world, one a column: turn [rad], then displacement of the body [m]. No column:
/// none.
using BodyMotions = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 3>;

/// The covariance of an ideal filter whose scans measure the pose against a map that it makes on the way: 17 errors in
/// the order of NavIndex and 6 by which the map here is displaced in the world. A motion that a scan does not see
/// displaces what is mapped from then on, and shows in nothing later.
class PosteriorCovariance {
 public:
  /// The first pose defines the world and the map; the rest is known as the options say.
  explicit PosteriorCovariance(const BoundOptions& options);

  /// `moved`: how far the body went [m], world.
  void propagate(const DiscreteModel& model, const Eigen::Vector3d& moved);

  /// A scan that does not see these motions since the scan before.
  void measure(const Eigen::Matrix3d& rotation, const BodyMotions& unseen);

  /// The velocity is known to be zero.
  void stand();

  /// From now on the position counts from here.
  void anchor_position();

  /// From now on the heading counts from here: the world turns by the heading's error psi = z^T R dtheta, and with it
  /// the velocity, dv <- dv - psi z x v.
  void anchor_heading(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& velocity_world);

  /// [m^2], world.
  Eigen::Matrix3d position() const { return p_.block<3, 3>(kPosition, kPosition); }

 private:
  static constexpr int kMapTurn = kNavDof, kMapShift = kNavDof + 3, kDof = kNavDof + 6;
  using Matrix = Eigen::Matrix<double, kDof, kDof>;

  /// One measurement of `row` times the error, of this 1 sigma.
  void observe(const Eigen::Matrix<double, kDof, 1>& row, double sigma);

  double position_sigma_, rotation_sigma_, standing_sigma_;
  Matrix p_ = Matrix::Zero();
};

}  // namespace allan_lio
