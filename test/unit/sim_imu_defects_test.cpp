// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "allan_lio/sim/imu_simulator.h"
#include "box_drive.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr double kRate = 200.0;  // [Hz]
constexpr double kPi = 3.14159265358979323846;

ImuDefects with(const std::function<void(ImuDefects&)>& set) {
  ImuDefects defects;
  set(defects);
  return defects;
}

/// Four sigma of an estimated variance, relative.
double variance_tolerance(double count) { return 4.0 * std::sqrt(2.0 / count); }

TEST(SimImuDefects, ScaleFactorMisalignmentAndGSensitivityAreSpreadAsToldAndConstant) {
  const ImuDefects told = with([](ImuDefects& d) {
    d.gyro.scale_factor = 500e-6, d.accel.scale_factor = 300e-6;
    d.gyro.misalignment = 1e-3, d.accel.misalignment = 2e-3;
    d.g_sensitivity = 1e-5;
  });
  double scale[2] = {}, cross[2] = {}, g = 0.0;
  constexpr int kSeeds = 2000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ImuDefectModel model(told, kRate, seed);
    const Eigen::Matrix3d errors[2] = {model.gyro_error(), model.accel_error()};
    for (const int k : {0, 1}) {
      const double on_axis = errors[k].diagonal().squaredNorm();
      scale[k] += on_axis / (3.0 * kSeeds);
      cross[k] += (errors[k].squaredNorm() - on_axis) / (6.0 * kSeeds);
    }
    g += model.g_sensitivity().squaredNorm() / (9.0 * kSeeds);
  }
  EXPECT_NEAR(scale[0] / (500e-6 * 500e-6), 1.0, variance_tolerance(3 * kSeeds));
  EXPECT_NEAR(scale[1] / (300e-6 * 300e-6), 1.0, variance_tolerance(3 * kSeeds));
  EXPECT_NEAR(cross[0] / 1e-6, 1.0, variance_tolerance(6 * kSeeds));
  EXPECT_NEAR(cross[1] / 4e-6, 1.0, variance_tolerance(6 * kSeeds));
  EXPECT_NEAR(g / 1e-10, 1.0, variance_tolerance(9 * kSeeds));
}

TEST(SimImuDefects, ReadingsAreTheTruthThroughTheMatricesThatTheModelTells) {
  ImuDefectModel model(with([](ImuDefects& d) {
                         d.gyro.scale_factor = d.accel.scale_factor = 1e-3;
                         d.gyro.misalignment = d.accel.misalignment = 2e-3;
                         d.g_sensitivity = 1e-5;
                       }),
                       kRate, 3);
  const ImuDefectModel::Reading truth{{0.3, -0.2, 0.5}, {1.0, -2.0, 9.8}};
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 3; ++k) {
    const ImuDefectModel::Reading felt = model.feel(truth);
    const Eigen::Vector3d gyro = (identity + model.gyro_error()) * truth.gyro + model.g_sensitivity() * truth.accel;
    EXPECT_LT((felt.gyro - gyro).norm(), 1e-15);
    EXPECT_LT((felt.accel - (identity + model.accel_error()) * truth.accel).norm(), 1e-14);
    EXPECT_GT((felt.gyro - truth.gyro).norm(), 1e-5);
  }
}

std::vector<Eigen::Vector3d> shaking(const ImuDefects& defects, int count, std::uint64_t seed) {
  ImuDefectModel model(defects, kRate, seed);
  std::vector<Eigen::Vector3d> values;
  for (int k = 0; k < count; ++k)
    values.push_back(model.feel({Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()}).accel);
  return values;
}

/// A line of frequency f and half width B has the autocorrelation rms^2 exp(-2 pi B t) cos(2 pi f t); sampled below
/// 2 f it is the one of the alias.
TEST(SimImuDefects, VibrationHasTheAutocorrelationOfItsLineAndShowsAtTheAlias) {
  constexpr double kRms = 0.3, kFrequency = 187.0, kBandwidth = 4.0;
  constexpr int kCount = 1500, kSeeds = 60;
  const ImuDefects told = with([&](ImuDefects& d) {
    d.accel.vibration = kRms, d.vibration_frequency = kFrequency, d.vibration_bandwidth = kBandwidth;
  });
  for (const int lag : {0, 1, 4, 8, 15}) {
    double sum = 0.0, square = 0.0, count = 0.0;
    for (int seed = 0; seed < kSeeds; ++seed) {
      const std::vector<Eigen::Vector3d> v = shaking(told, kCount, seed);
      double product = 0.0;
      for (int k = 0; k + lag < kCount; ++k) product += v[k].dot(v[k + lag]) / (3.0 * (kCount - lag) * kRms * kRms);
      sum += product;
      square += product * product;
      ++count;
    }
    const double mean = sum / count, error = std::sqrt((square / count - mean * mean) / count);
    const double time = lag / kRate, alias = kRate - kFrequency;
    EXPECT_NEAR(mean, std::exp(-2.0 * kPi * kBandwidth * time) * std::cos(2.0 * kPi * alias * time), 4.0 * error)
        << lag;
    EXPECT_LT(error, 0.02);
  }
}

TEST(SimImuDefects, AVibrationWithoutWidthIsAPureToneOfItsRms) {
  const std::vector<Eigen::Vector3d> v =
      shaking(with([](ImuDefects& d) { d.accel.vibration = 0.2, d.vibration_bandwidth = 0.0; }), 2000,
              5);  // 10 s: whole periods of the alias of 13 Hz
  for (int axis = 0; axis < 3; ++axis) {
    double square = 0.0, largest = 0.0;
    for (const Eigen::Vector3d& value : v) {
      square += value[axis] * value[axis] / 2000.0;
      largest = std::max(largest, std::abs(value[axis]));
    }
    EXPECT_NEAR(square, 0.04, 1e-6);
    EXPECT_NEAR(largest, 0.2 * std::sqrt(2.0), 1e-3);
  }
}

TEST(SimImuDefects, VibrationIsRectifiedToAShiftOfItsSquare) {
  const auto mean_of = [](double rectification) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& value : shaking(with([&](ImuDefects& d) {
                                                  d.accel.vibration = 0.5, d.vibration_bandwidth = 0.0;
                                                  d.rectification = rectification;
                                                }),
                                                2000, 5))
      mean += value / 2000.0;
    return mean;
  };
  EXPECT_LT((mean_of(2e-3) - mean_of(0.0) - Eigen::Vector3d::Constant(2e-3 * 0.25)).norm(), 1e-9);
}

TEST(SimImuDefects, ReadingsAreRoundedAndHeldWithinTheRange) {
  const ImuDefectModel model(with([](ImuDefects& d) {
                               d.gyro.quantization = 0.01, d.accel.quantization = 0.1;
                               d.gyro.range = 1.005, d.accel.range = 30.0;
                             }),
                             kRate, 1);
  const ImuDefectModel::Reading out = model.digitize({{0.1234, -2.0, 1.003}, {9.7777, 31.0, -0.04}});
  EXPECT_LT((out.gyro - Eigen::Vector3d(0.12, -1.005, 1.0)).norm(), 1e-15);
  EXPECT_LT((out.accel - Eigen::Vector3d(9.8, 30.0, 0.0)).norm(), 1e-15);
}

TEST(SimImuDefects, StampsRunByTheImusClock) {
  ImuDefectModel model(with([](ImuDefects& d) { d.clock_offset = -3e-3, d.clock_drift = 20e-6; }), kRate, 1);
  EXPECT_EQ(*model.stamp(0), -3000000);
  EXPECT_EQ(*model.stamp(100 * kNsPerSecond), 100 * kNsPerSecond - 3000000 + 2000000);
}

TEST(SimImuDefects, StampJitterHasItsSigmaAndNeverTurnsTheOrder) {
  const auto run = [](double sigma, double* square) {
    ImuDefectModel model(with([&](ImuDefects& d) { d.stamp_jitter = sigma; }), kRate, 1);
    TimeNs last = -kNsPerSecond;
    *square = 0.0;
    for (int k = 0; k < 20000; ++k) {
      const TimeNs time = k * 5000000LL, stamp = *model.stamp(time);
      ASSERT_GT(stamp, last);
      last = stamp;
      *square += std::pow(seconds_between(time, stamp), 2) / 20000.0;
    }
  };
  double square = 0.0;
  run(0.3e-3, &square);
  EXPECT_NEAR(square / 0.09e-6, 1.0, variance_tolerance(20000));
  run(20e-3, &square);  // far above the interval of 5 ms
  EXPECT_LE(square, 4e-6);
}

TEST(SimImuDefects, SamplesAreDroppedAtTheirRate) {
  ImuDefectModel model(with([](ImuDefects& d) { d.dropped_samples = 0.05; }), kRate, 1);
  int lost = 0;
  for (int k = 0; k < 20000; ++k) lost += !model.stamp(k * 5000000LL);
  EXPECT_NEAR(lost, 1000.0, 4.0 * std::sqrt(1000.0));
}

class SimImuDefectsOnTheWay : public ::testing::Test {
 protected:
  SimulatedImu run(const ImuDefects& defects, std::uint64_t seed = 5) const {
    ImuErrorConfig config;
    config.defects = defects;
    return simulate_imu(trajectory_, 4.0, kBoxStart, kRate, mti600_spec(), config, seed);
  }
  SimTrajectory trajectory_{fast_curve()};
};

TEST_F(SimImuDefectsOnTheWay, OneErrorLeavesTheOthersAlone) {
  const SimulatedImu plain = run({}), crossed = run(with([](ImuDefects&d) { d.accel.misalignment = 1e-3; }));
  const SimulatedImu real = run(mti600_defects()), still = run([] {
                                                     ImuDefects defects = mti600_defects();
                                                     defects.gyro.vibration = defects.clock_offset = 0.0;
                                                     return defects;
                                                   }());
  ASSERT_EQ(plain.samples.size(), crossed.samples.size());
  ASSERT_EQ(real.samples.size(), still.samples.size());
  for (std::size_t k = 0; k < plain.samples.size(); ++k) {
    ASSERT_EQ(plain.samples[k].gyro, crossed.samples[k].gyro);
    ASSERT_NE(plain.samples[k].accel, crossed.samples[k].accel);
    ASSERT_EQ(plain.gyro_bias[k], crossed.gyro_bias[k]);
  }
  for (std::size_t k = 0; k < real.samples.size(); ++k) {
    ASSERT_EQ(real.samples[k].accel, still.samples[k].accel);
    ASSERT_EQ(real.samples[k].stamp - still.samples[k].stamp, 1000000);
  }
}

TEST_F(SimImuDefectsOnTheWay, LostSamplesTakeTheirTruthWithThemAndTheSeedDecides) {
  const ImuDefects lossy = with([](ImuDefects& d) { d.dropped_samples = 0.1, d.clock_offset = 2e-3; });
  const SimulatedImu plain = run({}), some = run(lossy), same = run(lossy), other = run(lossy, 6);
  ASSERT_LT(some.samples.size(), plain.samples.size());
  ASSERT_EQ(some.samples.size(), some.true_stamps.size());
  ASSERT_EQ(some.samples.size(), some.gyro_bias.size());
  std::size_t at = 0;
  for (std::size_t k = 0; k < some.samples.size(); ++k) {
    EXPECT_EQ(some.samples[k].stamp, some.true_stamps[k] + 2000000);
    while (plain.samples[at].stamp != some.true_stamps[k]) ++at;
    ASSERT_EQ(some.samples[k].accel, plain.samples[at].accel);
    ASSERT_EQ(some.gyro_bias[k], plain.gyro_bias[at]);
    ASSERT_EQ(some.samples[k].stamp, same.samples[k].stamp);
  }
  EXPECT_NE(some.true_stamps, other.true_stamps);
}

TEST(SimImuDefects, DefectsThatCannotBeAreRefused) {
  const auto refused = [](const std::function<void(ImuDefects&)>& set) {
    EXPECT_THROW(ImuDefectModel(with(set), kRate, 1), std::invalid_argument);
  };
  refused([](ImuDefects& d) { d.gyro.scale_factor = -1e-3; });
  refused([](ImuDefects& d) { d.accel.quantization = std::nan(""); });
  refused([](ImuDefects& d) { d.dropped_samples = 1.0; });
  refused([](ImuDefects& d) { d.clock_offset = 1e3; });
  EXPECT_THROW(ImuDefectModel({}, 0.0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
