// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/math/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "central_differences.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 5e-14;
constexpr double kDifference = 1e-9;  // what central differences of fourth order with kStep are good for
constexpr double kStep = 1e-3;
constexpr double kSwitch = 0.5;  // [rad] so3.cpp turns from series to closed form here

const std::vector<double> kAngles = {0.0, 1e-9, 1e-5, 0.1, kSwitch - 1e-6, kSwitch + 1e-6, 1.0, 2.5, kPi - 1e-6};

std::vector<Eigen::Vector3d> rotation_vectors() {
  std::vector<Eigen::Vector3d> vectors;
  for (const double angle : kAngles)
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.3, -0.8, 0.5), Eigen::Vector3d(-0.1, 0.01, -1.0)})
      vectors.push_back(angle * axis.normalized());
  return vectors;
}

double distance(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return (a.toRotationMatrix() - b.toRotationMatrix()).cwiseAbs().maxCoeff();
}

/// Gamma_m = int_0^1 (1-s)^(m-1)/(m-1)! Exp(s phi) ds by Simpson's rule.
Eigen::Matrix3d gamma_by_quadrature(int m, const Eigen::Vector3d& phi) {
  constexpr int kPanels = 2000;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i <= kPanels; ++i) {
    const double s = static_cast<double>(i) / kPanels;
    const double weight = (i == 0 || i == kPanels ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / (3.0 * kPanels);
    const double power = std::pow(1.0 - s, m - 1) / std::tgamma(m);
    const double angle = s * phi.norm();
    const Eigen::AngleAxisd turn(angle, phi.norm() > 0 ? phi.normalized() : Eigen::Vector3d(Eigen::Vector3d::UnitX()));
    sum += weight * power * turn.toRotationMatrix();
  }
  return sum;
}

TEST(So3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1, -2, 3), b(0.5, 4, -1);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

TEST(So3, ExpIsEigensAngleAxis) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    if (phi.norm() == 0.0) continue;
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(phi.norm(), phi.normalized()));
    EXPECT_LT(distance(exp_so3(phi), expected), kRounding) << "phi = " << phi.transpose();
  }
  EXPECT_EQ(exp_so3(Eigen::Vector3d::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(So3, LogUndoesExpAtEveryAngle) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const double tolerance = kRounding * std::max(1e-3, phi.norm());  // small angles keep their relative accuracy
    EXPECT_LT((log_so3(exp_so3(phi)) - phi).norm(), tolerance) << "|phi| = " << phi.norm();
  }
}

TEST(So3, LogTakesTheShorterWayRound) {
  const Eigen::Vector3d phi(0.2, -0.4, 0.1);
  const Eigen::Quaterniond q = exp_so3(phi);
  const Eigen::Quaterniond negative(-q.w(), -q.x(), -q.y(), -q.z());
  EXPECT_LT((log_so3(negative) - phi).norm(), kRounding);
  EXPECT_NEAR(log_so3(exp_so3({0, 0, 1.5 * kPi})).z(), -0.5 * kPi, kRounding);
  EXPECT_NEAR(log_so3(exp_so3({0, kPi, 0})).norm(), kPi, kRounding);
}

TEST(So3, ExpOfLogIsTheSameRotation) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Quaterniond q = exp_so3(1.7 * phi);
    EXPECT_LT(distance(exp_so3(log_so3(q)), q), kRounding);
  }
}

TEST(So3, RightJacobianAgreesWithCentralDifferences) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::MatrixXd numeric = central_differences(
        [&](const Eigen::VectorXd& d) { return log_so3(exp_so3(phi).conjugate() * exp_so3(phi + d)); }, 3, kStep);
    EXPECT_LT((right_jacobian(phi) - numeric).cwiseAbs().maxCoeff(), kDifference) << "|phi| = " << phi.norm();
  }
}

TEST(So3, RightJacobianInverseIsTheInverse) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    const Eigen::Matrix3d product = right_jacobian(phi) * right_jacobian_inverse(phi);
    EXPECT_LT((product - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), kRounding) << "|phi| = " << phi.norm();
  }
}

TEST(So3, Gamma0IsExpAndGamma1TheLeftJacobian) {
  for (const Eigen::Vector3d& phi : rotation_vectors()) {
    EXPECT_LT((gamma_so3(0, phi) - exp_so3(phi).toRotationMatrix()).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LT((gamma_so3(1, phi) - exp_so3(phi).toRotationMatrix() * right_jacobian(phi)).cwiseAbs().maxCoeff(),
              kRounding);
  }
}

TEST(So3, GammaIntegralsAgreeWithQuadrature) {
  constexpr double kQuadrature = 1e-12;
  for (int m = 1; m <= 3; ++m)
    for (const Eigen::Vector3d& phi : rotation_vectors())
      EXPECT_LT((gamma_so3(m, phi) - gamma_by_quadrature(m, phi)).cwiseAbs().maxCoeff(), kQuadrature)
          << "m = " << m << ", |phi| = " << phi.norm();
}

TEST(So3, GammaDerivativesAgreeWithCentralDifferences) {
  const Eigen::Vector3d a(0.7, -9.0, 3.0);
  for (int m = 0; m <= 2; ++m)
    for (const Eigen::Vector3d& phi : rotation_vectors()) {
      const Eigen::MatrixXd numeric = central_differences(
          [&](const Eigen::VectorXd& d) { return Eigen::Vector3d(gamma_so3(m, phi + d) * a); }, 3, kStep);
      EXPECT_LT((gamma_so3_derivative(m, phi, a) - numeric).cwiseAbs().maxCoeff(), a.norm() * kDifference)
          << "m = " << m << ", |phi| = " << phi.norm();
    }
}

TEST(So3, SeriesAndClosedFormMeetWhereTheyAreSwitched) {
  // Over a step this small the functions themselves change by less than kContinuity.
  constexpr double kContinuity = 1e-12;
  const double below = std::nextafter(kSwitch, 0.0);
  const Eigen::Vector3d axis = Eigen::Vector3d(0.3, -0.8, 0.5).normalized(), a(0.7, -9.0, 3.0);
  for (int k = 1; k <= 5; ++k)
    EXPECT_NEAR(gamma_coefficient(k, below), gamma_coefficient(k, kSwitch), kContinuity) << "k = " << k;
  for (int m = 0; m <= 2; ++m) {
    // Well clear of the switch on both sides of it, whatever the rounding of the norm.
    const Eigen::Vector3d low = (kSwitch - 1e-14) * axis, high = (kSwitch + 1e-14) * axis;
    EXPECT_LT((gamma_so3(m, low) - gamma_so3(m, high)).cwiseAbs().maxCoeff(), kContinuity);
    EXPECT_LT((gamma_so3_derivative(m, low, a) - gamma_so3_derivative(m, high, a)).cwiseAbs().maxCoeff(),
              a.norm() * kContinuity);
  }
}

TEST(So3, GammaCoefficientsAreTheirSeries) {
  EXPECT_EQ(gamma_coefficient(1, 0.0), 1.0);
  EXPECT_EQ(gamma_coefficient(2, 0.0), 0.5);
  EXPECT_NEAR(gamma_coefficient(3, 0.0), 1.0 / 6.0, kRounding);
  for (const double theta : {1e-9, 0.3, 0.49, 0.51, 1.0, 3.0}) {
    EXPECT_NEAR(gamma_coefficient(0, theta), std::cos(theta), kRounding);
    EXPECT_NEAR(gamma_coefficient(1, theta), std::sin(theta) / theta, kRounding);
    EXPECT_NEAR(gamma_coefficient(2, theta), 2.0 * std::pow(std::sin(0.5 * theta) / theta, 2), kRounding);
  }
}

}  // namespace
}  // namespace allan_lio
