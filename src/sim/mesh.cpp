// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/mesh.h"

#include <Eigen/Geometry>
#include <cmath>

namespace allan_lio {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d turned(const Vector3d& p, const Vector3d& about, double yaw) {
  return about + Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * (p - about);
}

}  // namespace

void TriangleMesh::add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), {a, b, c});
  triangles.push_back({first, first + 1, first + 2});
}

void TriangleMesh::append(const TriangleMesh& other, const RigidTransform& T_this_other) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  for (const Vector3d& vertex : other.vertices) vertices.push_back(T_this_other * vertex);
  for (const auto& t : other.triangles) triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

void TriangleMesh::add_quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const auto first = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), {a, b, c, d});
  triangles.push_back({first, first + 1, first + 2});
  triangles.push_back({first, first + 2, first + 3});
}

void TriangleMesh::add_box(const Vector3d& low, const Vector3d& high, double yaw) {
  const Vector3d centre = 0.5 * (low + high);
  const auto corner = [&](bool x, bool y, bool z) {
    return turned({x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z()}, centre, yaw);
  };
  for (const bool side : {false, true}) {
    add_quad(corner(side, false, false), corner(side, true, false), corner(side, true, true),
             corner(side, false, true));
    add_quad(corner(false, side, false), corner(true, side, false), corner(true, side, true),
             corner(false, side, true));
    add_quad(corner(false, false, side), corner(true, false, side), corner(true, true, side),
             corner(false, true, side));
  }
}

void TriangleMesh::add_pillar(const Vector2d& centre, double radius, double low, double high) {
  constexpr int kSides = 12;
  constexpr double kSideAngle = 6.28318530717958647692 / kSides;
  const auto corner = [&](int i, double z) {
    return Vector3d(centre.x() + radius * std::cos(i * kSideAngle), centre.y() + radius * std::sin(i * kSideAngle), z);
  };
  for (int i = 0; i < kSides; ++i) {
    add_quad(corner(i, low), corner(i + 1, low), corner(i + 1, high), corner(i, high));
    add_triangle(corner(i, high), corner(i + 1, high), {centre.x(), centre.y(), high});
  }
}

void TriangleMesh::add_table(const Vector2d& centre, const Vector2d& size, double height, double yaw) {
  constexpr double kTop = 0.04, kLeg = 0.06;
  const Vector3d middle(centre.x(), centre.y(), height);
  const Vector3d half(0.5 * size.x(), 0.5 * size.y(), 0.0);
  add_box(middle - half - Vector3d(0, 0, kTop), middle + half, yaw);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      const Vector3d foot = turned(middle + Vector3d(x * (half.x() - kLeg), y * (half.y() - kLeg), 0), middle, yaw);
      add_box({foot.x() - 0.5 * kLeg, foot.y() - 0.5 * kLeg, 0.0},
              {foot.x() + 0.5 * kLeg, foot.y() + 0.5 * kLeg, height - kTop}, yaw);
    }
  }
}

void TriangleMesh::add_panel(const Vector3d& base, double width, double height, double yaw, double lean) {
  const Vector3d forward(std::cos(yaw), std::sin(yaw), 0.0);
  const Vector3d side = 0.5 * width * Vector3d(-forward.y(), forward.x(), 0.0);
  const Vector3d up = height * (std::cos(lean) * Vector3d::UnitZ() + std::sin(lean) * forward);
  add_quad(base - side, base + side, base + side + up, base - side + up);
}

}  // namespace allan_lio
