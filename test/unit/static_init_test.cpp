// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/static_init.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kG = 9.80665;
const InitOptions kOptions{kG, 0.02, 0.15, 10.0, 1.0};

NoiseSpec spec() {
  NoiseSpec s;
  s.gyro.white.setConstant(1.2e-4);
  s.accel.white.setConstant(6e-4);
  s.gyro.bias_instability.setConstant(4e-5);
  s.accel.bias_instability.setConstant(1e-4);
  s.gyro.bias_time.setConstant(30);
  s.accel.bias_time.setConstant(60);
  s.gyro.turn_on_bias.setConstant(3e-3);
  s.accel.turn_on_bias.setConstant(0.05);
  return s;
}

struct Truth {
  Eigen::Quaterniond rotation;
  Eigen::Vector3d gyro_bias, accel_bias;
};

std::vector<ImuSample> standstill(const Truth& truth, double seconds, double rate, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto noise = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  const Eigen::Vector3d force = truth.rotation.conjugate() * Eigen::Vector3d(0, 0, kG);
  std::vector<ImuSample> record;
  for (int i = 0; i <= seconds * rate; ++i)
    record.push_back({to_ns(i / rate), truth.gyro_bias + 1.2e-4 * std::sqrt(rate) * noise(),
                      force + truth.accel_bias + 6e-4 * std::sqrt(rate) * noise()});
  return record;
}

TEST(StaticInit, LevelsTheWorldAndKeepsTheHeadingAtZero) {
  std::mt19937 random(1);
  const Truth truth{exp_so3({0.2, -0.3, 1.1}), {}, {}};
  Truth still = truth;
  still.gyro_bias.setZero();
  still.accel_bias.setZero();
  const ImuNoise noise = make_imu_noise(spec(), {}, BiasModel::kRandomWalk);
  const InitialState initial = initialize(standstill(still, 1.0, 200, random), true, spec(), noise, kOptions);
  const Eigen::Vector3d up =
      initial.state.T_world_imu.rotation * (truth.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  constexpr double kTilt = 1e-3;  // [rad]
  EXPECT_LT((up - Eigen::Vector3d::UnitZ()).norm(), kTilt);
  const Eigen::Vector3d x = initial.state.T_world_imu.rotation * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(std::atan2(x.y(), x.x()), 0.0, 1e-9);
}

TEST(StaticInit, CovarianceOfBiasesAndTiltHoldsOverManyStarts) {
  // Normalised squared errors of the 8 quantities that a standstill tells of, against their chi-square mean.
  constexpr int kRuns = 400;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const NoiseSpec s = spec();
  const ImuNoise noise = make_imu_noise(s, {}, BiasModel::kRandomWalk);
  double gyro_sum = 0.0, accel_sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const auto draw = [&](double sigma) {
      return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
    };
    const Truth truth{exp_so3({0.1, 0.2, 0.0}), draw(3e-3), draw(0.05)};
    const InitialState initial = initialize(standstill(truth, 1.0, 200, random), true, s, noise, kOptions);
    // The true gravity in the world that the start laid out: the body's true tilt seen from the estimated rotation.
    const Eigen::Vector3d gravity =
        initial.state.T_world_imu.rotation * (truth.rotation.conjugate() * Eigen::Vector3d(0, 0, -kG));
    Eigen::Matrix<double, 5, 1> error;
    error << truth.accel_bias - initial.state.accel_bias, s2_minus(gravity, initial.state.gravity_world);
    const Eigen::Matrix<double, 5, 5> p = initial.covariance.block<5, 5>(kAccelBias, kAccelBias);
    accel_sum += error.dot(p.ldlt().solve(error));
    const Eigen::Vector3d gyro_error = truth.gyro_bias - initial.state.gyro_bias;
    gyro_sum += gyro_error.dot(initial.covariance.block<3, 3>(kGyroBias, kGyroBias).ldlt().solve(gyro_error));
  }
  // Mean of a chi-square with n degrees of freedom over N runs: n +- 3 sqrt(2 n / N).
  EXPECT_NEAR(gyro_sum / kRuns, 3.0, 3 * std::sqrt(6.0 / kRuns));
  EXPECT_NEAR(accel_sum / kRuns, 5.0, 3 * std::sqrt(10.0 / kRuns));
}

TEST(StaticInit, LongerStandstillMakesASmallerCovariance) {
  std::mt19937 random(3);
  const Truth truth{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const ImuNoise noise = make_imu_noise(spec(), {}, BiasModel::kRandomWalk);
  const auto one = initialize(standstill(truth, 1.0, 200, random), true, spec(), noise, kOptions);
  const auto four = initialize(standstill(truth, 4.0, 200, random), true, spec(), noise, kOptions);
  const auto expected = [&](double length) {
    return noise.gyro_psd.x() / length + noise.gyro_bias_psd.x() * length / 3;
  };
  EXPECT_DOUBLE_EQ(one.covariance(kGyroBias, kGyroBias), expected(1.0));
  EXPECT_DOUBLE_EQ(four.covariance(kGyroBias, kGyroBias), expected(4.0));
  EXPECT_LT(four.covariance(kGyroBias, kGyroBias), 0.3 * one.covariance(kGyroBias, kGyroBias));
}

TEST(StaticInit, TellsAMotionFromAStandstill) {
  std::mt19937 random(4);
  const Truth truth{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  auto record = standstill(truth, 1.0, 200, random);
  EXPECT_TRUE(is_still(record, spec(), kOptions));
  for (std::size_t i = 0; i < record.size(); ++i) record[i].accel.x() += 0.5 * std::sin(0.1 * static_cast<double>(i));
  EXPECT_FALSE(is_still(record, spec(), kOptions));
}

TEST(StaticInit, ASteadyRotationAndASteadyPushAreNoStandstill) {
  std::mt19937 random(6);
  Truth truth{Eigen::Quaterniond::Identity(), {0, 0, 0.5}, Eigen::Vector3d::Zero()};
  EXPECT_FALSE(is_still(standstill(truth, 1.0, 200, random), spec(), kOptions)) << "0.5 rad/s is no bias";
  truth = {Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), {0, 0, 2.0}};
  EXPECT_FALSE(is_still(standstill(truth, 1.0, 200, random), spec(), kOptions)) << "nor is 2 m/s^2";
}

TEST(StaticInit, TellsGFromMetresPerSecondSquared) {
  std::mt19937 random(5);
  const Truth truth{exp_so3({0.5, 0, 0}), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  auto record = standstill(truth, 0.5, 100, random);
  EXPECT_EQ(detect_accel_scale(record, kG), 1.0);
  for (ImuSample& sample : record) sample.accel /= kG;
  EXPECT_EQ(detect_accel_scale(record, kG), kG);
}

TEST(StaticInit, AnAbsurdReadingDoesNotHideTheUnit) {
  std::mt19937 random(5);
  const Truth truth{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  auto record = standstill(truth, 0.5, 100, random);
  for (ImuSample& sample : record) sample.accel /= kG;
  record[20].accel.z() = 450.0;
  EXPECT_EQ(detect_accel_scale(record, kG), kG);
  for (ImuSample& sample : record) sample.accel *= kG;
  record[20].accel.setZero();
  EXPECT_EQ(detect_accel_scale(record, kG), 1.0);
}

}  // namespace
}  // namespace allan_lio
