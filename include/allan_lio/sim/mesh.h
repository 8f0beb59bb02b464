// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "allan_lio/math/rigid_transform.h"

namespace allan_lio {

/// Surfaces as triangles, each seen from both sides.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add_triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

  /// Another mesh's triangles, taken to this one's frame by `T_this_other`.
  void append(const TriangleMesh& other, const RigidTransform& T_this_other);

  /// The planar quadrilateral a, b, c, d, corners in the order of its outline.
  void add_quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d);

  /// A box from corner `low` to corner `high`, turned about the vertical through its centre by `yaw` [rad].
  void add_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double yaw = 0.0);

  /// An upright pillar of twelve sides.
  void add_pillar(const Eigen::Vector2d& centre, double radius, double low, double high);

  /// A table top with four legs, centred at `centre`, turned by `yaw` [rad].
  void add_table(const Eigen::Vector2d& centre, const Eigen::Vector2d& size, double height, double yaw);

  /// A board that stands at `base` across the direction `yaw` [rad] and leans towards it by `lean` [rad] from upright.
  void add_panel(const Eigen::Vector3d& base, double width, double height, double yaw, double lean);
};

}  // namespace allan_lio
