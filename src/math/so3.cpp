// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/math/so3.h"

#include <cmath>

namespace allan_lio {
namespace {

constexpr double kSeriesBelow = 0.5;  // [rad] below it the power series is exact to rounding with kTerms terms
constexpr int kTerms = 9;

double factorial(int n) {
  double f = 1.0;
  for (int i = 2; i <= n; ++i) f *= i;
  return f;
}

/// dC_k/dtheta divided by theta.
double gamma_coefficient_slope(int k, double theta) {
  if (theta >= kSeriesBelow)
    return (gamma_coefficient(k - 1, theta) - k * gamma_coefficient(k, theta)) / (theta * theta);
  double sum = 0.0;
  double power = -1.0;  // (-1)^j theta^(2j-2)
  for (int j = 1; j <= kTerms; ++j) {
    sum += power * 2 * j / factorial(2 * j + k);
    power *= -theta * theta;
  }
  return sum;
}

}  // namespace

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return m;
}

double gamma_coefficient(int k, double theta) {
  if (theta >= kSeriesBelow) {
    // C_0 and C_1 in closed form, then C_k = (1/(k-2)! - C_{k-2}) / theta^2.
    double c = k % 2 == 0 ? std::cos(theta) : std::sin(theta) / theta;
    for (int i = 2 + k % 2; i <= k; i += 2) c = (1.0 / factorial(i - 2) - c) / (theta * theta);
    return c;
  }
  double sum = 0.0;
  double power = 1.0;
  for (int j = 0; j < kTerms; ++j) {
    sum += power / factorial(2 * j + k);
    power *= -theta * theta;
  }
  return sum;
}

Eigen::Quaterniond exp_so3(const Eigen::Vector3d& phi) {
  const double half = 0.5 * phi.norm();
  const double sinc = gamma_coefficient(1, half);
  const Eigen::Vector3d v = 0.5 * sinc * phi;
  return Eigen::Quaterniond(std::cos(half), v.x(), v.y(), v.z()).normalized();
}

Eigen::Vector3d log_so3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;  // the shorter of the two ways round
  const double sin_half = q.vec().norm();
  const double cos_half = sign * q.w();
  const double half = std::atan2(sin_half, cos_half);
  const double scale = sin_half < 1e-7 ? 2.0 / cos_half : 2.0 * half / sin_half;
  return sign * scale * q.vec();
}

Eigen::Matrix3d gamma_so3(int m, const Eigen::Vector3d& phi) {
  const double theta = phi.norm();
  const Eigen::Matrix3d hat = skew(phi);
  return Eigen::Matrix3d::Identity() / factorial(m) + gamma_coefficient(m + 1, theta) * hat +
         gamma_coefficient(m + 2, theta) * hat * hat;
}

Eigen::Matrix3d gamma_so3_derivative(int m, const Eigen::Vector3d& phi, const Eigen::Vector3d& a) {
  const double theta = phi.norm();
  const Eigen::Vector3d cross = phi.cross(a);
  const Eigen::Vector3d double_cross = phi.cross(cross);
  return -gamma_coefficient(m + 1, theta) * skew(a) + gamma_coefficient_slope(m + 1, theta) * cross * phi.transpose() +
         gamma_coefficient(m + 2, theta) *
             (phi.dot(a) * Eigen::Matrix3d::Identity() + phi * a.transpose() - 2.0 * a * phi.transpose()) +
         gamma_coefficient_slope(m + 2, theta) * double_cross * phi.transpose();
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) { return gamma_so3(1, -phi); }

Eigen::Matrix3d right_jacobian_inverse(const Eigen::Vector3d& phi) {
  // I + skew/2 + c skew^2 with c = 1/theta^2 - (1+cos)/(2 theta sin) = (C_2 - 2 C_4 ... ) in the C_k:
  // written as (1 - C_1/(2 C_2))/theta^2, whose numerator is theta^2 (C_3 - 2 C_4) / (2 C_2).
  const double theta = phi.norm();
  const double c =
      (gamma_coefficient(3, theta) - 2.0 * gamma_coefficient(4, theta)) / (2.0 * gamma_coefficient(2, theta));
  const Eigen::Matrix3d hat = skew(phi);
  return Eigen::Matrix3d::Identity() + 0.5 * hat + c * hat * hat;
}

}  // namespace allan_lio
