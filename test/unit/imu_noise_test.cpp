// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "allan_lio/imu/noise_report.h"

// The figures are those of the paper where they follow from its formulas, with g = 9.80665 m/s^2.

namespace allan_lio {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;  // [rad]
constexpr double kDegreePerHour = kDegree / 3600.0;         // [rad/s]
constexpr double kDegreePerRootHour = kDegree / 60.0;       // [rad/s/sqrt(Hz)]
constexpr double kMicroG = 9.80665e-6;                      // [m/s^2]

Eigen::Vector3d same(double value) { return Eigen::Vector3d::Constant(value); }

/// The MTi-600 of the paper's LiDAR experiments.
NoiseSpec mti600() {
  NoiseSpec spec;
  spec.gyro.white = same(0.42 * kDegreePerRootHour);
  spec.accel.white = same(60 * kMicroG);
  spec.gyro.bias_instability = same(8 * kDegreePerHour);
  spec.accel.bias_instability = same(10 * kMicroG);
  spec.gyro.bias_time = same(31.7);
  spec.accel.bias_time << 63.5, 63.5, 31.7;
  return spec;
}

TEST(ImuNoise, GaussMarkovAllanShapePeaksAtThePublishedPoint) {
  EXPECT_NEAR(gauss_markov_peak_lambda(), 1.8926, 5e-5);
  EXPECT_NEAR(gauss_markov_peak_value(), 0.190569, 5e-7);
  EXPECT_NEAR(1.0 / gauss_markov_peak_value(), 5.2474, 1e-4);
  EXPECT_NEAR(std::sqrt(gauss_markov_peak_value()), 0.4365, 5e-5);  // the paper's figure
}

TEST(ImuNoise, NothingExceedsThePeak) {
  const double peak = gauss_markov_peak_lambda();
  for (const double factor : {0.5, 0.9, 0.999, 1.001, 1.1, 2.0})
    EXPECT_LT(gauss_markov_allan_shape(factor * peak), gauss_markov_peak_value()) << "factor " << factor;
}

TEST(ImuNoise, GaussMarkovAllanShapeHasItsLimitsAndNoStep) {
  EXPECT_NEAR(gauss_markov_allan_shape(1e-6) / (1e-6 / 3.0), 1.0, 1e-5) << "a random walk at short times";
  EXPECT_NEAR(gauss_markov_allan_shape(1e4) / 1e-4, 1.0, 1e-3) << "white noise at long times";
  constexpr double kSeriesBelow = 1e-3;
  const double below = gauss_markov_allan_shape(std::nextafter(kSeriesBelow, 0.0));
  EXPECT_NEAR(gauss_markov_allan_shape(kSeriesBelow) / below, 1.0, 1e-6);
}

TEST(ImuNoise, GaussMarkovAllanShapeIsTheAllanVarianceOfTheProcess) {
  // sigma^2(tau) = (1/(2 tau^2)) E[(y2 - y1)^2] with y1, y2 the integrals of b over neighbouring intervals, by
  // quadrature of the autocovariance R(s) = (S T/2) e^(-|s|/T), S = T = 1:
  // sigma^2 = (1/tau^2) int_0^tau (tau - s) [2 R(s) - R(s + tau) - R(tau - s)] ds.
  for (const double tau : {0.01, 0.5, 1.8926, 10.0}) {
    constexpr int kPanels = 20000;
    double sum = 0.0;
    for (int i = 0; i < kPanels; ++i) {
      const double s = (i + 0.5) * tau / kPanels;
      const auto r = [](double lag) { return 0.5 * std::exp(-lag); };
      sum += (tau - s) * (2 * r(s) - r(s + tau) - r(tau - s)) * tau / kPanels;
    }
    EXPECT_NEAR(gauss_markov_allan_shape(tau) / (sum / (tau * tau)), 1.0, 1e-5) << "tau " << tau;
  }
}

TEST(ImuNoise, Adis16465FiguresAreThePapersWithStandardGravity) {
  const auto gyro = [](double tau_flat) {
    const Eigen::Vector3d s = bias_psd(same(2 * kDegreePerHour), same(correlation_time_from_flat(tau_flat)));
    return s.x() / (kDegree * kDegree);
  };
  const auto accel = [](double micro_g, double tau_flat) {
    return bias_psd(same(3.6 * micro_g), same(correlation_time_from_flat(tau_flat))).x();
  };
  EXPECT_NEAR(correlation_time_from_flat(200.0), 105.7, 0.05);
  // The printed figures come from the peak rounded to 1.89 (0.14 %) and 1/F to 5.25 (0.05 %).
  constexpr double kRounded = 0.002;
  EXPECT_NEAR(gyro(200.0), 1.532e-8, kRounded * 1.532e-8);
  EXPECT_NEAR(gyro(1000.0), 3.06e-9, kRounded * 3.06e-9);
  EXPECT_NEAR(accel(kMicroG, 200.0), 6.185e-11, kRounded * 6.185e-11);
  EXPECT_NEAR(accel(kMicroG, 80.0), 1.547e-10, kRounded * 1.547e-10);
  EXPECT_NEAR(accel(1e-5, 200.0), 6.431e-11, kRounded * 6.431e-11) << "the paper's, which takes 1 ug for 1e-5 m/s^2";
  // What the formulas give without rounding on the way.
  EXPECT_NEAR(gyro(200.0), 1.53262e-8, 5e-14);
  EXPECT_NEAR(accel(kMicroG, 200.0), 6.18908e-11, 5e-16);
}

TEST(ImuNoise, FastLio2DefaultsAreTheseMultiplesOfTheMti600) {
  constexpr double kRate = 400.0;                         // [Hz]
  const double white = 0.1 / kRate, bias = 1e-4 / kRate;  // S = Q_d dt
  const ImuNoise noise = make_imu_noise(mti600(), NoiseScale{}, BiasModel::kRandomWalk);
  constexpr double kPrinted = 0.01;  // the published figures have two decimals
  EXPECT_NEAR(std::sqrt(bias / noise.gyro_bias_psd.x()), 31.68, kPrinted);
  EXPECT_NEAR(std::sqrt(bias / noise.accel_bias_psd.z()), 12.54, kPrinted);
  EXPECT_NEAR(std::sqrt(bias / noise.accel_bias_psd.x()), 17.74, kPrinted);
  EXPECT_NEAR(std::sqrt(white / noise.gyro_psd.x()), 129.4, 0.05);
  EXPECT_NEAR(std::sqrt(white / noise.accel_psd.x()), 26.9, 0.05);
}

TEST(ImuNoise, WithTheseMultipliersTheMti600BecomesFastLio2sDefaults) {
  NoiseScale scale;
  scale.k_g = 129.42;
  scale.k_a = 26.872;
  scale.k_gb = 31.6855;
  const ImuNoise noise = make_imu_noise(mti600(), scale, BiasModel::kRandomWalk);
  EXPECT_NEAR(noise.gyro_psd.x() * 400.0, 0.1, 1e-5);
  EXPECT_NEAR(noise.accel_psd.x() * 400.0, 0.1, 1e-5);
  EXPECT_NEAR(noise.gyro_bias_psd.x() * 400.0, 1e-4, 1e-8);
}

TEST(ImuNoise, MultipliersEnterSquaredAndOnlyTheirOwnBlock) {
  const ImuNoise one = make_imu_noise(mti600(), NoiseScale{}, BiasModel::kRandomWalk);
  NoiseScale scale;
  scale.k_g = 2;
  scale.k_a = 3;
  scale.k_gb = 5;
  scale.k_ab = 7;
  const Eigen::Matrix<double, 12, 1> ratio =
      make_imu_noise(mti600(), scale, BiasModel::kRandomWalk).spectral_density().cwiseQuotient(one.spectral_density());
  const double expected[] = {4, 9, 25, 49};
  for (int i = 0; i < 12; ++i) EXPECT_NEAR(ratio[i], expected[i / 3], 1e-12) << "entry " << i;
}

TEST(ImuNoise, SpectralDensityHoldsTheSquaredAmplitudesAxisByAxis) {
  NoiseSpec spec = mti600();
  spec.gyro.white << 1, 2, 3;
  spec.accel.white << 4, 5, 6;
  spec.gyro.bias_instability << 7, 8, 9;
  spec.accel.bias_instability << 10, 11, 12;
  spec.gyro.bias_time = same(2.0);
  const Eigen::Matrix<double, 12, 1> s = make_imu_noise(spec, NoiseScale{}, BiasModel::kRandomWalk).spectral_density();
  for (int i = 0; i < 6; ++i) EXPECT_EQ(s[i], (i + 1.0) * (i + 1.0)) << "entry " << i;
  for (int i = 6; i < 9; ++i)
    EXPECT_NEAR(s[i], (i + 1.0) * (i + 1.0) / (2.0 * gauss_markov_peak_value()), 1e-10) << "entry " << i;
  EXPECT_NEAR(s[11] / s[9], 1.44 * 63.5 / 31.7, 1e-12);
}

TEST(ImuNoise, ARandomWalkHasNoDecayAndAGaussMarkovBiasDecaysWithItsTime) {
  const ImuNoise walk = make_imu_noise(mti600(), NoiseScale{}, BiasModel::kRandomWalk);
  const ImuNoise markov = make_imu_noise(mti600(), NoiseScale{}, BiasModel::kGaussMarkov);
  EXPECT_EQ(walk.gyro_bias_rate, Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(walk.accel_bias_rate, Eigen::Vector3d(0, 0, 0));
  EXPECT_NEAR(markov.gyro_bias_rate.y(), 1.0 / 31.7, 1e-15);
  EXPECT_NEAR(markov.accel_bias_rate.x(), 1.0 / 63.5, 1e-15);
  EXPECT_NEAR(markov.accel_bias_rate.z(), 1.0 / 31.7, 1e-15);
  EXPECT_EQ(walk.spectral_density(), markov.spectral_density());
}

TEST(ImuNoise, TheFourWaysToTellABiasGiveOneDensity) {
  constexpr double kRelative = 1e-14, kRate = 200.0;
  const SensorNoise allan = mti600().accel;
  const Eigen::Vector3d density = bias_psd(allan);
  for (const BiasKind kind : {BiasKind::kAllan, BiasKind::kRandomWalk, BiasKind::kGaussMarkov}) {
    const SensorNoise told = convert_bias(allan, kind, 0.0);
    EXPECT_EQ(bias_kind(told), kind);
    EXPECT_LT(bias_psd(told).cwiseQuotient(density).maxCoeff(), 1.0 + kRelative);
    EXPECT_GT(bias_psd(told).cwiseQuotient(density).minCoeff(), 1.0 - kRelative);
    EXPECT_EQ(told.white, allan.white);
  }
  const SensorNoise back = from_discrete(to_discrete(allan, kRate), kRate);
  EXPECT_LT((bias_psd(back).cwiseQuotient(density).array() - 1.0).abs().maxCoeff(), kRelative);
  EXPECT_LT((back.white.cwiseQuotient(allan.white).array() - 1.0).abs().maxCoeff(), kRelative);
}

TEST(ImuNoise, AGaussMarkovDeviationIsTwiceItsSquareOverItsTimeInTheDensity) {
  SensorNoise sensor;
  sensor.bias_sigma = same(3.0);
  sensor.bias_time = same(9.0);
  EXPECT_EQ(bias_psd(sensor), same(2.0));
}

TEST(ImuNoise, ARandomWalkNeedsATimeToBeToldAsAnyOtherKind) {
  SensorNoise sensor;
  sensor.bias_random_walk = same(1e-3);
  EXPECT_THROW(convert_bias(sensor, BiasKind::kAllan, 0.0), std::invalid_argument);
  const SensorNoise allan = convert_bias(sensor, BiasKind::kAllan, 100.0);
  EXPECT_EQ(allan.bias_time, same(100.0));
  EXPECT_NEAR(bias_psd(allan).y(), 1e-6, 1e-20);
  NoiseSpec spec = mti600();
  spec.gyro = sensor;
  EXPECT_EQ(make_imu_noise(spec, NoiseScale{}, BiasModel::kGaussMarkov).gyro_bias_rate, same(0.0));
}

TEST(ImuNoise, TheImpliedMultipliersAreThoseThatWerePutIn) {
  NoiseSpec louder = mti600();
  louder.gyro.white *= 2;
  louder.accel.white *= 3;
  louder.gyro.bias_instability *= 5;
  louder.accel = [&] {
    SensorNoise accel = louder.accel;
    accel.bias_instability *= 7;
    return convert_bias(accel, BiasKind::kRandomWalk, 0.0);
  }();
  const NoiseScale scale = implied_scale(louder, mti600());
  constexpr double kRelative = 1e-14;
  EXPECT_NEAR(scale.k_g, 2, 2 * kRelative);
  EXPECT_NEAR(scale.k_a, 3, 3 * kRelative);
  EXPECT_NEAR(scale.k_gb, 5, 5 * kRelative);
  EXPECT_NEAR(scale.k_ab, 7, 7 * kRelative);
}

TEST(NoiseReport, TellsTheFiguresInForceAndWhatFiltersWithCovariancesWouldTake) {
  NoiseScale scale;
  scale.k_gb = 2.0;
  std::string text;
  for (const std::string& line : describe_noise(mti600(), scale, 400.0)) text += line + "\n";
  for (const char* part :
       {"400 Hz", "N_g = 0.42 deg/sqrt(h) (k_g = 1)", "sigma_bg = 16 deg/h, T_bg = 31.7 s", "(k_gb = 2)",
        "S = 1.493e-08 (rad/s)^2/Hz", "covariance 5.971e-06 (rad/s)^2", "T_ba = 63.5, 63.5, 31.7 s",
        "N_a = 60 ug/sqrt(Hz)", "K = 3.156e-05 rad/s^2/sqrt(Hz)", "3.99e-05 m/s^3/sqrt(Hz)"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " is not in\n" << text;
}

}  // namespace
}  // namespace allan_lio
