// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace allan_lio {

/// T_a_b: takes coordinates in frame b to frame a, `p_a = T_a_b * p_b = R_a_b p_b + t_a_b` [m].
struct RigidTransform {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }

  /// T_a_c = T_a_b * T_b_c.
  RigidTransform operator*(const RigidTransform& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }

  RigidTransform inverse() const {
    const Eigen::Quaterniond back = rotation.conjugate();
    return {back, -(back * translation)};
  }
};

}  // namespace allan_lio
