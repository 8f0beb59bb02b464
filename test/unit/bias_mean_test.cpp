// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/bias_mean.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "allan_lio/imu/discretize.h"
#include "allan_lio/imu/propagate.h"

namespace allan_lio {
namespace {

constexpr double kStep = 0.1;       // of a scan [s]
constexpr double kTime = 30.0;      // T_b [s]
constexpr double kWander = 2e-4;    // steady-state deviation of the process
constexpr double kConstant = 5e-3;  // turn-on bias

ImuNoise wandering(double rate) {
  ImuNoise noise;
  noise.gyro_bias_rate.setConstant(rate);
  noise.accel_bias_rate.setConstant(rate);
  noise.gyro_bias_psd.setConstant(2.0 * kWander * kWander / kTime);
  noise.accel_bias_psd = noise.gyro_bias_psd;
  return noise;
}

DiscreteModel model_of(const ImuNoise& noise) {
  const NavState rest;
  return discretize(rest, {kStep, {0.1, 0.2, -0.3}, -rest.gravity_world}, noise, Discretization::kTrapezoid);
}

TEST(BiasMean, CarryingIsTheTransitionsProduct) {
  std::mt19937_64 bits(2);
  std::normal_distribution<double> normal;
  NavMatrix phi = NavMatrix::NullaryExpr([&] { return 0.1 * normal(bits); });
  InertialMatrix root = InertialMatrix::NullaryExpr([&] { return normal(bits); });
  const InertialMatrix square = root * root.transpose(), before = 0.5 * (square + square.transpose());
  const InertialVector error = InertialVector::NullaryExpr([&] { return normal(bits); });
  const InertialMatrix whole = with_bias_means(phi);
  InertialMatrix covariance = before;
  InertialVector carried = error;
  carry(phi, covariance);
  carry(phi, carried);
  EXPECT_LT((covariance - whole * before * whole.transpose()).norm(), 1e-12 * before.norm());
  EXPECT_LT((carried - whole * error).norm(), 1e-12 * error.norm());
  EXPECT_EQ(covariance, InertialMatrix(covariance.transpose()));
  EXPECT_EQ(carried.tail<6>(), error.tail<6>()) << "a mean stays";
}

// Gelb 1974, section 3.6: of a Gauss-Markov process known at 0 the variance after t is sigma^2 (1 - e^-2t/T); the
// constant part adds its own by the square of what of it has come through, 1 - e^-t/T.
TEST(BiasMean, ABiasThatIsKnownNowGoesBackToItsMean) {
  const ImuNoise noise = wandering(1.0 / kTime);
  const DiscreteModel model = model_of(noise);
  InertialMatrix p = InertialMatrix::Zero();
  p.diagonal().tail<6>().setConstant(kConstant * kConstant);
  int steps = 0;
  for (const double t : {5.0, 30.0, 300.0}) {
    for (; steps < static_cast<int>(std::lround(t / kStep)); ++steps) {
      carry(model.phi, p);
      p.topLeftCorner<kNavDof, kNavDof>() += model.q;
    }
    const double through = 1.0 - std::exp(-t / kTime);
    const double expected =
        kConstant * kConstant * through * through + kWander * kWander * (1.0 - std::exp(-2.0 * t / kTime));
    for (const int index : {kGyroBias + 0, kGyroBias + 2, kAccelBias + 1}) {
      EXPECT_NEAR(p(index, index), expected, 1e-3 * expected) << "of " << index << " after " << t;
      const int mean = index + kGyroBiasMean - kGyroBias;
      EXPECT_NEAR(p(index, mean), kConstant * kConstant * through, 1e-6 * kConstant * kConstant);
      EXPECT_EQ(p(mean, mean), kConstant * kConstant);
    }
  }
}

TEST(BiasMean, ARandomWalkHasNone) {
  const DiscreteModel model = model_of(wandering(0.0));
  InertialMatrix p = InertialMatrix::Zero();
  p.diagonal().tail<6>().setConstant(1.0);
  carry(model.phi, p);
  EXPECT_TRUE(p.topRightCorner(kNavDof, 6).isZero(0));
  NavState state;
  state.gyro_bias << 0.1, 0.2, 0.3;
  p.setIdentity();
  NoiseSpec spec;
  spec.gyro.turn_on_bias.setConstant(kConstant);
  split_biases(spec, wandering(0.0), state, p);
  EXPECT_TRUE(state.gyro_bias_mean.isZero(0));
  EXPECT_TRUE(p.rightCols<6>().isZero(0)) << "a mean that nothing hangs on is known";
}

/// Of both parts, by a Kalman step on their sum.
TEST(BiasMean, TheStartTellsTheTwoPartsApartAsOneMeasurementOfTheirSumDoes) {
  NoiseSpec spec;
  spec.gyro.turn_on_bias << 1e-3, 2e-4, 0.0;
  spec.accel.turn_on_bias.setConstant(kConstant);
  const ImuNoise noise = wandering(1.0 / kTime);
  constexpr double kOffset = 0.01, kRead = 0.0123, kReading = 3e-4;  // the mean before, the reading, its deviation
  for (int axis = 0; axis < 3; ++axis) {
    // (constant, wander): prior, and posterior by the reading.
    Eigen::Matrix2d prior = Eigen::Vector2d(std::pow(spec.gyro.turn_on_bias[axis], 2), kWander * kWander).asDiagonal();
    const Eigen::RowVector2d h(1.0, 1.0);
    const double innovation = h * prior * h.transpose() + kReading * kReading;
    const Eigen::Vector2d gain = prior * h.transpose() / innovation;
    const Eigen::Vector2d mean = Eigen::Vector2d(kOffset, 0.0) + gain * (kRead - kOffset);
    const Eigen::Matrix2d posterior = prior - gain * h * prior;

    NavState state;
    state.gyro_bias_mean[axis] = kOffset;
    state.gyro_bias[axis] = mean.sum();
    InertialMatrix p = InertialMatrix::Zero();
    p(kGyroBias + axis, kGyroBias + axis) = posterior.sum();
    p(kGyroBias + axis, kVelocity) = p(kVelocity, kGyroBias + axis) = 0.3 * posterior.sum();
    p(kVelocity, kVelocity) = 1.0;
    split_biases(spec, noise, state, p);
    const double unit = prior.sum();
    const int b = kGyroBias + axis, c = kGyroBiasMean + axis;
    EXPECT_NEAR(state.gyro_bias_mean[axis], mean[0], 1e-15);
    EXPECT_NEAR(p(c, c), posterior(0, 0), 1e-12 * unit) << axis;
    EXPECT_NEAR(p(b, c), posterior.row(0).sum(), 1e-12 * unit) << axis;
    EXPECT_EQ(p(c, b), p(b, c));
    EXPECT_EQ(p(b, b), posterior.sum()) << "what is known of the sum stays";
    EXPECT_NEAR(p(kVelocity, c), 0.3 * posterior.row(0).sum(), 1e-12 * unit) << "and goes along with all else";
  }
}

TEST(BiasMean, TheMeansArePartOfTheDifference) {
  NavState x, y;
  y.gyro_bias_mean << 1, 2, 3;
  y.accel_bias_mean << 4, 5, 6;
  y.velocity_world << 7, 8, 9;
  const InertialVector delta = inertial_minus(y, x);
  EXPECT_EQ(delta.segment<3>(kGyroBiasMean), y.gyro_bias_mean);
  EXPECT_EQ(delta.segment<3>(kAccelBiasMean), y.accel_bias_mean);
  EXPECT_EQ(delta.head<kNavDof>(), nav_minus(y, x));
}

}  // namespace
}  // namespace allan_lio
