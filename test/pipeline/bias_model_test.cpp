// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// The two models of a bias through the whole filter.
#include <gtest/gtest.h>

#include <cmath>

#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr double kSeconds = 30.0;
constexpr double kGyroAdded = 5e-3, kAccelAdded = 0.02;  // to all axes, within the turn-on bias [rad/s], [m/s^2]

const SimulatedDrive& drive() {
  static const SimulatedDrive drive = simulate_drive("rooms", kSeconds, 4);
  return drive;
}

LioResult last_of(const SimulatedDrive& drive, BiasModel model, double turn_on = 1.0) {
  LioConfig config = simulated_robot();
  config.imu.bias_model = model;
  config.imu.spec.gyro.turn_on_bias *= turn_on;
  config.imu.spec.accel.turn_on_bias *= turn_on;
  return run_odometry(drive, config).back();
}

Eigen::Vector3d variances(const LioResult& result, int index) { return result.covariance.diagonal().segment<3>(index); }

TEST(BiasModel, AGaussMarkovBiasHasAConstantPartThatIsEstimated) {
  SimulatedDrive other = drive();
  for (ImuSample& sample : other.imu) {
    sample.gyro.array() += kGyroAdded;
    sample.accel.array() += kAccelAdded;
  }
  const LioResult before = last_of(drive(), BiasModel::kGaussMarkov), after = last_of(other, BiasModel::kGaussMarkov);
  const NavState &a = before.state.nav, &b = after.state.nav;
  EXPECT_LT((b.gyro_bias_mean - a.gyro_bias_mean - Eigen::Vector3d::Constant(kGyroAdded)).norm(), 0.01 * kGyroAdded);
  EXPECT_NEAR(b.accel_bias_mean.z() - a.accel_bias_mean.z(), kAccelAdded, 0.05 * kAccelAdded);
  // The constant is known less well than the sum, which was seen, and both far better than at the start.
  const LioConfig::Imu imu = simulated_robot().imu;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GT(variances(before, kGyroBiasMean)[axis], variances(before, kGyroBias)[axis]);
    EXPECT_LT(variances(before, kGyroBiasMean)[axis], 1e-3 * std::pow(imu.spec.gyro.turn_on_bias[axis], 2));
  }
}

TEST(BiasModel, ItsWanderIsBoundedAndThatOfARandomWalkIsNot) {
  const LioResult markov = last_of(drive(), BiasModel::kGaussMarkov), walk = last_of(drive(), BiasModel::kRandomWalk);
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LT(variances(markov, kGyroBias)[axis], variances(walk, kGyroBias)[axis]) << axis;
  EXPECT_TRUE(walk.state.nav.gyro_bias_mean.isZero(0));
  EXPECT_TRUE(walk.covariance.middleRows<6>(kGyroBiasMean).isZero(0)) << "a random walk has no mean";
}

TEST(BiasModel, WithoutATurnOnBiasItDecaysToZero) {
  const LioResult result = last_of(drive(), BiasModel::kGaussMarkov, 0.0);
  EXPECT_TRUE(result.state.nav.gyro_bias_mean.isZero(0));
  EXPECT_TRUE(result.covariance.middleRows<6>(kGyroBiasMean).isZero(0));
}

}  // namespace
}  // namespace allan_lio
