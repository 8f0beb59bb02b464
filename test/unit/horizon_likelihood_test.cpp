// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/horizon_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "allan_lio/io/config_source.h"

namespace allan_lio {
namespace {

constexpr double kImuRate = 100.0;    // [Hz]
constexpr int kSamplesPerScan = 10;   // of the IMU
constexpr double kGyroWhite = 1e-3;   // [rad/s/sqrt(Hz)]
constexpr double kAccelWhite = 1e-2;  // [m/s^2/sqrt(Hz)]
constexpr double kGravity = 9.80665;  // [m/s^2]
constexpr double kScale = 5.0;        // of the scene [m]
constexpr double kLog2Pi = 1.83787706640934548356;

LioConfig noise_config(double k = 1.0) {
  NoiseSpec spec;
  spec.gyro.white.setConstant(kGyroWhite);
  spec.accel.white.setConstant(kAccelWhite);
  spec.gyro.bias_random_walk.setConstant(1e-12);
  spec.accel.bias_random_walk.setConstant(1e-12);
  LioConfig config = default_config(spec);
  config.imu.scale.k_g = config.imu.scale.k_a = k;
  return config;
}

std::vector<ImuSample> imu_at_rest(double seconds) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= static_cast<int>(seconds * kImuRate); ++i)
    samples.push_back({to_ns(i / kImuRate), Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, kGravity)});
  return samples;
}

/// White noise of the specification times `k`, from sample `begin` on.
void add_noise(std::vector<ImuSample>& samples, double k, unsigned seed, std::size_t begin = 0) {
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = begin; i < samples.size(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      samples[i].gyro[axis] += k * kGyroWhite * std::sqrt(kImuRate) * normal(engine);
      samples[i].accel[axis] += k * kAccelWhite * std::sqrt(kImuRate) * normal(engine);
    }
}

/// The state of an IMU at rest, known to `sigma` in all that there is.
LioResult rest_at(double seconds, double sigma = 1e-6) {
  LioResult result;
  result.state.nav.stamp = to_ns(seconds);
  result.covariance = LioMatrix::Identity() * sigma * sigma;
  result.localizability.scale = kScale;
  return result;
}

HorizonLikelihood at_rest(double seconds, const LioConfig& config, void (*change)(LioResult&) = nullptr) {
  HorizonLikelihood likelihood(config);
  const int scans = static_cast<int>(seconds * kImuRate) / kSamplesPerScan;
  for (int i = 0; i <= scans; ++i) {
    LioResult result = rest_at(i * kSamplesPerScan / kImuRate);
    if (change != nullptr) change(result);
    likelihood.add(result);
  }
  return likelihood;
}

/// Only the heading and the height are supported.
void two_directions(LioResult& result) {
  result.localizability.support.setZero();
  result.localizability.support[2] = result.localizability.support[5] = 1.0;
}

TEST(HorizonLikelihood, OfOneHorizonItIsTheClosedForm) {
  const double heading_rate = 2e-3, rise = 5e-3;  // errors of the readings [rad/s, m/s^2]
  std::vector<ImuSample> imu = imu_at_rest(3.5);
  for (ImuSample& sample : imu) sample.gyro.z() += heading_rate, sample.accel.z() += rise;
  const double t = kHorizons[0];
  const HorizonScore score = at_rest(3.5, noise_config(), two_directions).score(imu, 1.0);
  // Of the begins at 0, 0.75, ... the first alone has an end in the record.
  const double heading_variance = kGyroWhite * kGyroWhite * t;
  const double height_variance = kAccelWhite * kAccelWhite * t * t * t / 3.0;
  const double nis =
      std::pow(heading_rate * t, 2) / heading_variance + std::pow(rise * t * t / 2.0, 2) / height_variance;
  const double nll =
      0.5 * (nis + std::log(kScale * kScale * heading_variance * height_variance)) + kLog2Pi - 2.0 * std::log(t);
  EXPECT_NEAR(score.nis, 0.25 * nis, 1e-3 * nis);
  EXPECT_NEAR(score.nll, 0.25 * nll, 1e-3);
  EXPECT_DOUBLE_EQ(score.dof, 0.25 * 2.0);
  EXPECT_EQ(score.independent_share, 1.0);
}

TEST(HorizonLikelihood, ReadingsInOtherUnitsAreScaled) {
  std::vector<ImuSample> imu = imu_at_rest(12.0);
  add_noise(imu, 1.0, 3);
  const HorizonLikelihood likelihood = at_rest(12.0, noise_config());
  const double nll = likelihood.score(imu, 1.0).nll;
  for (ImuSample& sample : imu) sample.accel /= kGravity;
  EXPECT_NEAR(likelihood.score(imu, kGravity).nll, nll, 1e-9 * std::abs(nll));
}

TEST(HorizonLikelihood, WithTheTrueNoiseTheErrorsAreWhatIsExpectedAndTheLikelihoodIsHighest) {
  constexpr double kSeconds = 600.0;
  for (const double truth : {1.0, 3.0}) {
    std::vector<ImuSample> imu = imu_at_rest(kSeconds);
    add_noise(imu, truth, 11);
    const HorizonScore right = at_rest(kSeconds, noise_config(truth)).score(imu, 1.0);
    // Some 1200 independent components, those of 10 and 30 s made of those of 3 s.
    EXPECT_NEAR(right.nis / right.dof, 1.0, 0.15);
    EXPECT_NEAR(right.dof, 6.0 * kSeconds * (1.0 / 3.0 + 1.0 / 10.0 + 1.0 / 30.0), 18.0)
        << "less one of each, at the end";
    EXPECT_GT(right.independent_share, 0.3);
    for (const double factor : {0.8, 1.25})
      EXPECT_LT(right.nll, at_rest(kSeconds, noise_config(truth * factor)).score(imu, 1.0).nll) << factor;
  }
}

TEST(HorizonLikelihood, WhereTheRunWasSetRightTheErrorIsNotTheNoises) {
  // Half a metre, 20 s after the start, that no reading tells of.
  const auto score = [](double told) {
    HorizonLikelihood likelihood(noise_config());
    for (int i = 0; i <= 400; ++i) {
      LioResult result = rest_at(i * kSamplesPerScan / kImuRate);
      if (i >= 200) result.state.nav.T_world_imu.translation.x() = 0.5;
      if (i == 200) result.relocated[3] = told;
      likelihood.add(result);
    }
    std::vector<ImuSample> imu = imu_at_rest(40.0);
    add_noise(imu, 1.0, 5);
    const HorizonScore found = likelihood.score(imu, 1.0);
    return found.nis / found.dof;
  };
  EXPECT_GT(score(0.0), 3.0);
  EXPECT_NEAR(score(0.5), 1.0, 0.4);
}

TEST(HorizonLikelihood, WhatNoScanSupportsScoresNothing) {
  const auto blind = [](LioResult& result) { result.localizability.support.setZero(); };
  const HorizonScore score = at_rest(40.0, noise_config(), blind).score(imu_at_rest(40.0), 1.0);
  EXPECT_EQ(score.nll, 0.0);
  EXPECT_EQ(score.dof, 0.0);
}

TEST(HorizonLikelihood, AScanThatDidNotUpdateIsNeitherBeginNorEnd) {
  const auto unmatched = [](LioResult& result) { result.outcome = ScanOutcome::kTooFewMatches; };
  EXPECT_EQ(at_rest(40.0, noise_config(), unmatched).score(imu_at_rest(40.0), 1.0).dof, 0.0);
}

TEST(HorizonLikelihood, AnEstimateThatKnowsNoMoreThanThePredictionIsHeldAgainstAQuarterOfIt) {
  const double drift = 0.01;  // of the reading [rad/s]
  std::vector<ImuSample> imu = imu_at_rest(3.5);
  for (ImuSample& sample : imu) sample.gyro.z() += drift;
  const auto vague = [](LioResult& result) {
    two_directions(result);
    result.covariance(2, 2) = 4.0;  // of the heading [rad^2], far more than three seconds of noise
  };
  const double t = kHorizons[0];
  const double nis = std::pow(drift * t, 2) / (HorizonLikelihood::kLeastGain * (4.0 + kGyroWhite * kGyroWhite * t));
  EXPECT_NEAR(at_rest(3.5, noise_config(), vague).score(imu, 1.0).nis, 0.25 * nis, 1e-6 * nis);
}

TEST(HorizonLikelihood, ErrorsThatComeInSpellsAreWorthLess) {
  constexpr double kSeconds = 600.0;
  std::vector<ImuSample> imu = imu_at_rest(kSeconds);
  add_noise(imu, 1.0, 5);
  const double even = at_rest(kSeconds, noise_config()).score(imu, 1.0).independent_share;
  add_noise(imu, 5.0, 6, imu.size() / 2);
  const double uneven = at_rest(kSeconds, noise_config()).score(imu, 1.0).independent_share;
  EXPECT_LT(uneven, 0.5 * even);
  EXPECT_GT(uneven, 0.0);
}

TEST(HorizonLikelihood, AnErrorWithoutMeasureCountsAsTheWorst) {
  std::vector<ImuSample> imu = imu_at_rest(3.5);
  imu[100].gyro.x() = std::numeric_limits<double>::quiet_NaN();
  const HorizonScore broken = at_rest(3.5, noise_config()).score(imu, 1.0);
  EXPECT_EQ(broken.nll, 0.25 * HorizonLikelihood::kWorstHorizonNll);
  EXPECT_EQ(broken.nis, 0.0);
  EXPECT_EQ(at_rest(2.0, noise_config()).score(imu_at_rest(2.0), 1.0).nll, 0.0) << "shorter than any horizon";
  EXPECT_EQ(at_rest(10.0, noise_config()).score({}, 1.0).nll, 0.0) << "without an IMU";
}

}  // namespace
}  // namespace allan_lio
