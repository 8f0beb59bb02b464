// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/propagate.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/lio/bias_mean.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kImuRate = 100.0;  // [Hz]
constexpr double kScale = 5.0;      // of the scene [m]

LioConfig noise_config() {
  NoiseSpec spec;
  spec.gyro.white.setConstant(1e-3);
  spec.accel.white << 1e-2, 2e-2, 3e-2;
  spec.gyro.bias_sigma.setConstant(1e-4);
  spec.accel.bias_sigma.setConstant(1e-3);
  spec.gyro.bias_time.setConstant(100.0);
  spec.accel.bias_time.setConstant(200.0);
  LioConfig config = default_config(spec);
  config.imu.bias_model = BiasModel::kGaussMarkov;
  config.imu.discretization = Discretization::kTrapezoid;
  return config;
}

std::vector<ImuSample> turning_imu(double seconds) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= static_cast<int>(seconds * kImuRate); ++i)
    samples.push_back(
        {to_ns(i / kImuRate), Eigen::Vector3d(0.1, -0.2, 0.3 + 0.01 * i), Eigen::Vector3d(0.2, 0.1, 9.8)});
  return samples;
}

LioResult state_at(double seconds) {
  LioResult result;
  result.state.nav.stamp = to_ns(seconds);
  result.state.nav.T_world_imu.rotation = exp_so3({0.1 * seconds, 0.2, 0.3});
  result.state.nav.T_world_imu.translation << seconds, 2.0, 3.0;
  result.state.nav.velocity_world << 1.0, 0.0, 0.1;
  result.state.nav.gyro_bias << 1e-3, 2e-3, 3e-3;
  result.state.nav.gyro_bias_mean << 2e-3 + 1e-4 * seconds, 1e-3, 4e-3;
  result.covariance = LioMatrix::Identity() * 1e-4;
  result.localizability.scale = kScale;
  return result;
}

LinearRun run_of(const LioConfig& config, const std::vector<LioResult>& results, const std::vector<ImuSample>& imu,
                 double accel_scale = 1.0) {
  LinearRunRecorder recorder;
  for (const LioResult& result : results) recorder.add(result);
  return recorder.finish(config, imu, accel_scale);
}

TEST(LinearRun, ItsPartsAddUpToWhatTheFilterWouldAddWithAnyK) {
  LioConfig config = noise_config();
  const std::vector<ImuSample> imu = turning_imu(1.0);
  const LinearRun run = run_of(config, {state_at(0.2), state_at(0.35)}, imu);
  const double k[] = {2.0, 0.5, 3.0, 0.7};
  const ImuNoise noise = make_imu_noise(config.imu.spec, {k[0], k[1], k[2], k[3]}, config.imu.bias_model);
  ImuBuffer buffer;
  for (const ImuSample& sample : imu) buffer.push(sample);
  const auto samples = buffer.between(to_ns(0.2), to_ns(0.35));
  NavState nav = state_at(0.2).state.nav;
  NavMatrix phi = NavMatrix::Identity(), q = NavMatrix::Zero();
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ImuInterval interval = mean_interval(nav, samples[i - 1], samples[i]);
    const DiscreteModel model = discretize(nav, interval, noise, Discretization::kTrapezoid);
    phi = (model.phi * phi).eval();
    q = (model.phi * q * model.phi.transpose() + model.q).eval();
    nav = propagate_mean(nav, interval, noise);
  }
  const LinearScan& scan = run.scans[1];
  NavMatrix sum = scan.bridged;
  for (std::size_t i = 0; i < 4; ++i) sum += k[i] * k[i] * scan.noise[i];
  EXPECT_LT((scan.phi - phi).norm(), 1e-12);
  EXPECT_LT((sum - q).norm(), 1e-12 * q.norm());
  EXPECT_EQ(scan.bridged, NavMatrix(NavMatrix::Zero())) << "there is neither gap nor saturation";
  EXPECT_LT((scan.correction - inertial_minus(state_at(0.35).state.nav, nav)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(scan.step, 0.15);
  EXPECT_DOUBLE_EQ(scan.time, 0.15);
  EXPECT_EQ(run.initial_covariance, InertialMatrix(1e-4 * InertialMatrix::Identity()));
  EXPECT_EQ(run.gyro_psd, Eigen::Vector3d(Eigen::Vector3d::Constant(1e-6)));
}

TEST(LinearRun, DoesNotDependOnTheConfigurationsMultipliersOfTheImu) {
  LioConfig config = noise_config();
  const std::vector<LioResult> states = {state_at(0.2), state_at(0.3)};
  const LinearRun plain = run_of(config, states, turning_imu(1.0));
  config.imu.scale = {7.0, 7.0, 7.0, 7.0};
  config.lidar.k_r = 3.0;
  const LinearRun scaled = run_of(config, states, turning_imu(1.0));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(scaled.scans[1].noise[i], plain.scans[1].noise[i]);
  EXPECT_EQ(scaled.k_r, 3.0);
}

TEST(LinearRun, BeginsWithTheLastStateThatWasHeldStanding) {
  std::vector<LioResult> states = {state_at(0.2), state_at(0.3), state_at(0.4), state_at(0.5), state_at(0.6)};
  states[1].standing = states[2].standing = true;
  states[2].covariance *= 3.0;
  const LinearRun run = run_of(noise_config(), states, turning_imu(1.0));
  ASSERT_EQ(run.scans.size(), 3U);
  EXPECT_NEAR(run.initial_covariance(0, 0), 3e-4, 1e-12);
  EXPECT_DOUBLE_EQ(run.scans[1].time, 0.1);
}

TEST(LinearRun, WhereTheRunWasSetRightTheErrorMayBeThatMuchWhateverTheK) {
  std::vector<LioResult> states = {state_at(0.2), state_at(0.3)};
  states[1].relocated << 0.0, 0.0, 0.02, 0.6, 0.0, 0.0;
  const NavMatrix bridged = run_of(noise_config(), states, turning_imu(1.0)).scans[1].bridged;
  EXPECT_NEAR(bridged(kPosition, kPosition), 0.36, 1e-12);
  EXPECT_NEAR(bridged(kTheta + 2, kPosition), 0.012, 1e-12);
  EXPECT_EQ(bridged(kVelocity, kVelocity), 0.0);
}

TEST(LinearRun, ReadingsInOtherUnitsAreScaled) {
  std::vector<ImuSample> imu = turning_imu(1.0);
  const std::vector<LioResult> states = {state_at(0.2), state_at(0.3)};
  const InertialVector correction = run_of(noise_config(), states, imu).scans[1].correction;
  for (ImuSample& sample : imu) sample.accel /= 9.80665;
  EXPECT_LT((run_of(noise_config(), states, imu, 9.80665).scans[1].correction - correction).norm(), 1e-12);
}

TEST(LinearRun, WhatBridgesAGapIsApartFromWhatTheKMultiply) {
  std::vector<ImuSample> imu = turning_imu(1.0);
  imu.erase(imu.begin() + 25, imu.begin() + 50);  // a quarter of a second
  const LinearRun run = run_of(noise_config(), {state_at(0.2), state_at(0.6)}, imu);
  EXPECT_GT(run.scans[1].bridged(kTheta, kTheta), 100.0 * run.scans[1].noise[0](kTheta, kTheta));
}

TEST(LinearRun, MeasuresThePoseInTheDirectionsThatAreSupported) {
  LioResult result = state_at(0.3);
  PoseVector truth;  // of the pose about the state
  truth << 1e-3, -2e-3, 1e-3, 0.01, 0.02, -0.03;
  PoseVector information;
  information << 4e4, 5e4, 6e4, 1e3, 2e3, 3e3;
  NavVector moved = NavVector::Zero();
  moved.head<6>() << 2e-4, 0.0, 0.0, 0.001, 0.002, 0.0;
  result.measurement.at = nav_plus(result.state.nav, moved);
  result.measurement.information = information.asDiagonal();
  result.measurement.gradient = information.cwiseProduct(truth - moved.head<6>());
  result.measurement.view_kept = 0.9;
  result.measurement.deskewed = 0.1;
  result.localizability.support << 1.0, 1.0, 1.0, 0.2, 1.0, 0.8;
  const LinearScan scan = run_of(noise_config(), {state_at(0.2), result}, turning_imu(1.0)).scans[1];
  ASSERT_EQ(scan.rows.rows(), 5) << "along x nothing is measured";
  const SupportedVector expected = scan.rows * truth;
  EXPECT_LT((scan.measured - expected).norm(), 1e-6) << "but for what is not linear in two ten thousandths";
  EXPECT_NEAR(scan.measured[0], kScale * truth[0], 1e-6) << "rotations in metres at the scene's scale";
  EXPECT_NEAR(scan.variances[0], kScale * kScale / information[0], 1e-12);
  EXPECT_NEAR(scan.variances[4], 1.0 / (0.8 * information[5]), 1e-12);
  // The map's axes are the world's.
  const Eigen::Matrix3d rotation = result.state.nav.T_world_imu.rotation.toRotationMatrix();
  EXPECT_LT((scan.map_rows.leftCols<3>() * rotation - scan.rows.leftCols<3>()).norm(), 1e-12);
  EXPECT_EQ(scan.map_rows.rightCols<3>(), scan.rows.rightCols<3>());
  EXPECT_EQ(scan.view_kept, 0.9);
  EXPECT_EQ(scan.deskewed, 0.1);
}

TEST(LinearRun, AScanThatDidNotUpdateMeasuresNothing) {
  LioResult result = state_at(0.3);
  result.outcome = ScanOutcome::kTooFewMatches;
  const LinearRun run = run_of(noise_config(), {state_at(0.2), result}, turning_imu(1.0));
  EXPECT_EQ(run.scans[1].rows.rows(), 0);
  EXPECT_EQ(run.scans.size(), 2U);
  EXPECT_TRUE(run_of(noise_config(), {}, turning_imu(1.0)).scans.empty());
  EXPECT_TRUE(run_of(noise_config(), {result}, {}).scans.empty()) << "without an IMU";
}

}  // namespace
}  // namespace allan_lio
