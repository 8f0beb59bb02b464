// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/math/s2.h"

#include <cmath>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

/// h(c) = theta/sin(theta) and dh/dc, with c = cos(theta).
struct SincInverse {
  double value;
  double slope;
};

SincInverse sinc_inverse(double c, double s) {
  const double t = 1.0 - c;
  if (t < 1e-4) return {1.0 + t / 3.0 + 2.0 * t * t / 15.0, -1.0 / 3.0 - 4.0 * t / 15.0};
  const double h = std::atan2(s, c) / s;
  return {h, (h * c - 1.0) / (s * s)};
}

}  // namespace

Eigen::Matrix<double, 3, 2> s2_basis(const Eigen::Vector3d& x) {
  // Continuous in each half space z > 0 and z < 0, so that an error about gravity keeps its meaning while gravity
  // moves a little (Duff et al., "Building an orthonormal basis, revisited", 2017).
  const Eigen::Vector3d u = x.normalized();
  const double sign = std::copysign(1.0, u.z());
  const double a = -1.0 / (sign + u.z());
  const double b = u.x() * u.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) << 1.0 + sign * u.x() * u.x() * a, sign * b, -sign * u.x();
  basis.col(1) << b, sign + u.y() * u.y() * a, -u.y();
  return basis;
}

Eigen::Vector3d s2_plus(const Eigen::Vector3d& x, const Eigen::Vector2d& d) { return exp_so3(s2_basis(x) * d) * x; }

Eigen::Vector2d s2_minus(const Eigen::Vector3d& y, const Eigen::Vector3d& x) {
  const Eigen::Vector3d u = x.normalized(), w = y.normalized();
  const Eigen::Vector3d cross = u.cross(w);
  return s2_basis(x).transpose() * cross * sinc_inverse(u.dot(w), cross.norm()).value;
}

Eigen::Matrix<double, 3, 2> s2_plus_jacobian(const Eigen::Vector3d& x) { return -skew(x) * s2_basis(x); }

Eigen::Matrix2d s2_minus_jacobian(const Eigen::Vector3d& y, const Eigen::Vector3d& x) {
  const Eigen::Vector3d u = x.normalized(), w = y.normalized();
  const Eigen::Vector3d cross = u.cross(w);
  const SincInverse h = sinc_inverse(u.dot(w), cross.norm());
  const Eigen::Matrix<double, 3, 2> dw = s2_plus_jacobian(w);  // s2_basis depends on the direction only
  return s2_basis(x).transpose() * (h.value * skew(u) + h.slope * cross * u.transpose()) * dw;
}

}  // namespace allan_lio
