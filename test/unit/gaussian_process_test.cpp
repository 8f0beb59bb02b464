// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/gaussian_process.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>

#include "allan_lio/sim/random.h"

namespace allan_lio {
namespace {

constexpr double kExact = 1e-12;
constexpr double kTwoPi = 6.28318530717958647692;

double matern(double distance, double length) {
  const double r = std::sqrt(5.0) * std::abs(distance) / length;
  return (1.0 + r + r * r / 3.0) * std::exp(-r);
}

TEST(GaussianProcess, TwoPointsAgreeWithTheClosedForm) {
  constexpr double kLength = 1.3, kSignal = 2.0, kNoise = 0.5, kAt = 0.4;
  const Eigen::RowVector2d x(0.0, 1.0);
  const Eigen::Vector2d y(3.0, 5.0);
  const GaussianProcess process(x, y, {Eigen::VectorXd::Constant(1, kLength), kSignal, kNoise});
  // K = [p q; q p]; by symmetry the constant mean is that of the two values.
  const double p = kSignal * kSignal + kNoise * kNoise, q = kSignal * kSignal * matern(1.0, kLength);
  const double a = kSignal * kSignal * matern(kAt, kLength), b = kSignal * kSignal * matern(1.0 - kAt, kLength);
  const double det = p * p - q * q, mean = 4.0;
  EXPECT_NEAR(process.mean(), mean, kExact);
  const GaussianProcess::Prediction there = process.predict(Eigen::VectorXd::Constant(1, kAt));
  EXPECT_NEAR(there.mean, mean + ((a * p - b * q) * (y[0] - mean) + (b * p - a * q) * (y[1] - mean)) / det, kExact);
  EXPECT_NEAR(there.variance, kSignal * kSignal - (a * a * p - 2.0 * a * b * q + b * b * p) / det, kExact);
  const double square = (p * 2.0 + 2.0 * q) / det;  // of the residuals -1 and 1 by K's inverse
  EXPECT_NEAR(process.log_marginal_likelihood(), -0.5 * square - 0.5 * std::log(det) - std::log(kTwoPi), kExact);
}

TEST(GaussianProcess, WithoutNoiseItGoesThroughItsPoints) {
  const Eigen::RowVector3d x(-1.0, 0.2, 2.0);
  const Eigen::Vector3d y(3.0, -1.0, 0.5);
  const GaussianProcess process(x, y, {Eigen::VectorXd::Constant(1, 0.8), 1.5, 0.0});
  for (int i = 0; i < 3; ++i) {
    const GaussianProcess::Prediction there = process.predict(x.col(i));
    EXPECT_NEAR(there.mean, y[i], 1e-9);
    EXPECT_NEAR(there.variance, 0.0, 1e-9);
  }
}

TEST(GaussianProcess, TheFitSeesWhichCoordinateMattersAndHowLargeTheNoiseIs) {
  constexpr int kPoints = 60;
  constexpr double kNoise = 0.1;
  NormalStream normals(3, 1);
  Eigen::MatrixXd x(2, kPoints);
  Eigen::VectorXd y(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    x(0, i) = 8.0 * uniform_from_bits(hash_bits(2 * i));
    x(1, i) = 8.0 * uniform_from_bits(hash_bits(2 * i + 1));
    y[i] = std::sin(x(0, i)) + kNoise * normals.next();
  }
  const GaussianProcess process = GaussianProcess::fit(x, y, Eigen::Vector2d(8.0, 8.0));
  EXPECT_GT(process.scales().length[1], 3.0 * process.scales().length[0]);
  EXPECT_GT(process.scales().noise, 0.5 * kNoise);
  EXPECT_LT(process.scales().noise, 2.0 * kNoise);
  EXPECT_NEAR(process.predict(Eigen::Vector2d(4.0, 4.0)).mean, std::sin(4.0), 2.0 * kNoise);
}

TEST(GaussianProcess, RefusesSizesThatDoNotFitAndTwicedPointsWithoutNoise) {
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  EXPECT_THROW(GaussianProcess(Eigen::RowVector2d(0, 1), Eigen::Vector3d(0, 1, 2), {one, 1.0, 0.1}),
               std::invalid_argument);
  EXPECT_THROW(GaussianProcess(Eigen::RowVector2d(0, 1), Eigen::Vector2d(0, 1), {-one, 1.0, 0.1}),
               std::invalid_argument);
  EXPECT_THROW(GaussianProcess(Eigen::RowVector2d(1, 1), Eigen::Vector2d(0, 1), {one, 1.0, 0.0}), std::runtime_error);
}

TEST(ExpectedImprovement, AgreesWithTheIntegralOverTheNormalDensity) {
  constexpr int kSteps = 200000;
  constexpr double kFar = 10.0, kClose = 1e-8;
  for (const double mean : {-1.0, 0.0, 0.7, 2.5}) {
    for (const double deviation : {0.3, 1.0}) {
      double sum = 0.0;
      const double step = 2.0 * kFar / kSteps;
      for (int i = 0; i < kSteps; ++i) {
        const double z = -kFar + (i + 0.5) * step;
        sum += std::max(0.0, 0.5 - (mean + deviation * z)) * std::exp(-0.5 * z * z) / std::sqrt(kTwoPi) * step;
      }
      EXPECT_NEAR(expected_improvement(mean, deviation, 0.5), sum, kClose);
    }
  }
  EXPECT_EQ(expected_improvement(0.2, 0.0, 0.5), 0.3);
  EXPECT_EQ(expected_improvement(0.7, 0.0, 0.5), 0.0);
}

}  // namespace
}  // namespace allan_lio
