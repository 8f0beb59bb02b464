// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/math/s2.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "central_differences.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr double kRounding = 5e-14;
constexpr double kStep = 1e-3;
constexpr double kDifference = 1e-9;  // what central differences of fourth order with kStep are good for

std::vector<Eigen::Vector3d> directions() {
  std::vector<Eigen::Vector3d> result;
  for (const Eigen::Vector3d& d :
       {Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(1, 1, 1),
        Eigen::Vector3d(0.6, -0.2, 0.7), Eigen::Vector3d(1e-9, 0, 1), Eigen::Vector3d(1e-5, -1e-5, -1)})
    result.push_back(kGravity * d.normalized());
  return result;
}

TEST(S2, BasisIsOrthonormalAndPerpendicular) {
  for (const Eigen::Vector3d& x : directions()) {
    const Eigen::Matrix<double, 3, 2> b = s2_basis(x);
    EXPECT_LT((b.transpose() * b - Eigen::Matrix2d::Identity()).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LT((b.transpose() * x).norm(), kGravity * kRounding);
    EXPECT_LT((s2_basis(3.0 * x) - b).cwiseAbs().maxCoeff(), kRounding) << "the length must not matter";
  }
}

TEST(S2, PlusKeepsTheLengthAndTurnsByTheStepsNorm) {
  for (const Eigen::Vector3d& x : directions())
    for (const double angle : {1e-9, 1e-5, 0.3, 1.0, 3.0}) {
      const Eigen::Vector3d y = s2_plus(x, angle * Eigen::Vector2d(0.6, -0.8));
      EXPECT_NEAR(y.norm(), kGravity, kGravity * kRounding);
      EXPECT_NEAR(std::atan2(x.cross(y).norm(), x.dot(y)), angle, kRounding);
    }
}

TEST(S2, MinusUndoesPlusAtEveryAngle) {
  for (const Eigen::Vector3d& x : directions())
    for (const double angle : {0.0, 1e-9, 1e-5, 0.01, 0.0141, 0.0142, 1.0, 2.0, kPi - 1e-6}) {
      const Eigen::Vector2d d = angle * Eigen::Vector2d(std::cos(0.4), std::sin(0.4));
      // Next to the opposite direction the axis is a difference of nearly equal numbers, sin(angle) apart.
      const double tolerance = kRounding * std::max(1.0, 1.0 / std::max(1e-6, std::abs(std::sin(angle))) * (angle > 2));
      EXPECT_LT((s2_minus(s2_plus(x, d), x) - d).norm(), tolerance) << "angle " << angle << ", x " << x.transpose();
    }
}

TEST(S2, PlusUndoesMinusBetweenAnyTwoDirections) {
  for (const Eigen::Vector3d& x : directions())
    for (const Eigen::Vector3d& y : directions()) {
      if (x.dot(y) < -0.999 * kGravity * kGravity) continue;  // opposite: the way is not unique
      EXPECT_LT((s2_plus(x, s2_minus(y, x)) - y).norm(), 1e-12);
    }
}

TEST(S2, PlusJacobianAgreesWithCentralDifferences) {
  for (const Eigen::Vector3d& x : directions()) {
    const Eigen::MatrixXd numeric =
        central_differences([&](const Eigen::VectorXd& d) { return s2_plus(x, Eigen::Vector2d(d)); }, 2, kStep);
    EXPECT_LT((s2_plus_jacobian(x) - numeric).cwiseAbs().maxCoeff(), kGravity * kDifference);
  }
}

TEST(S2, MinusJacobianAgreesWithCentralDifferences) {
  for (const Eigen::Vector3d& x : directions())
    for (const double angle : {0.0, 1e-9, 1e-5, 0.0141, 0.0142, 0.5, 1.0, 2.0}) {
      const Eigen::Vector3d y = s2_plus(x, angle * Eigen::Vector2d(0.6, 0.8));
      const Eigen::MatrixXd numeric = central_differences(
          [&](const Eigen::VectorXd& d) { return s2_minus(s2_plus(y, Eigen::Vector2d(d)), x); }, 2, kStep);
      EXPECT_LT((s2_minus_jacobian(y, x) - numeric).cwiseAbs().maxCoeff(), kDifference)
          << "angle " << angle << ", x " << x.transpose();
    }
}

}  // namespace
}  // namespace allan_lio
