// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/random.h"
#include "allan_lio/sim/scene.h"
#include "box_drive.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr double kRate = 200.0;  // [Hz]
constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// The MTi-600 of the paper, with turn-on biases.
NoiseSpec test_spec() {
  NoiseSpec spec;
  spec.gyro.white.setConstant(0.42 * kDegree / 60.0);
  spec.accel.white.setConstant(60e-6 * kSimGravity);
  spec.gyro.bias_instability.setConstant(8.0 * kDegree / 3600.0);
  spec.accel.bias_instability.setConstant(10e-6 * kSimGravity);
  spec.gyro.bias_time.setConstant(31.7);
  spec.accel.bias_time = Eigen::Vector3d(63.5, 63.5, 31.7);
  spec.gyro.turn_on_bias.setConstant(0.2 * kDegree);
  spec.accel.turn_on_bias.setConstant(5e-3 * kSimGravity);
  return spec;
}

/// Mean square over values whose mean is zero.
struct MeanSquare {
  double sum = 0.0;
  int count = 0;
  void add(const Eigen::Vector3d& v, const Eigen::Vector3d& unit) {
    sum += v.cwiseQuotient(unit).squaredNorm();
    count += 3;
  }
  double value() const { return sum / count; }
  double tolerance() const { return 4.0 * std::sqrt(2.0 / count); }  // four sigma of an estimated variance
};

TEST(SimImu, WhiteNoiseHasTheDensityOfTheSpecification) {
  const NoiseSpec spec = test_spec();
  ImuErrorModel model(spec, {}, kRate, 7);
  MeanSquare gyro, accel;
  for (int k = 0; k < 50000; ++k) {
    const ImuErrorModel::Errors errors = model.next();
    gyro.add(errors.gyro_white, spec.gyro.white * std::sqrt(kRate));
    accel.add(errors.accel_white, spec.accel.white * std::sqrt(kRate));
  }
  EXPECT_NEAR(gyro.value(), 1.0, gyro.tolerance());
  EXPECT_NEAR(accel.value(), 1.0, accel.tolerance());
}

TEST(SimImu, BiasesMoveByTheDrivingNoiseOfTheSpecification) {
  const NoiseSpec spec = test_spec();
  const Eigen::Vector3d gyro_psd = bias_psd(spec.gyro.bias_instability, spec.gyro.bias_time);
  const Eigen::Vector3d accel_psd = bias_psd(spec.accel.bias_instability, spec.accel.bias_time);
  ImuErrorModel model(spec, {}, kRate, 8);
  MeanSquare gyro, accel;
  ImuErrorModel::Errors last = model.next();
  for (int k = 0; k < 50000; ++k) {
    const ImuErrorModel::Errors errors = model.next();
    gyro.add(errors.gyro_bias - last.gyro_bias, (gyro_psd / kRate).cwiseSqrt());
    accel.add(errors.accel_bias - last.accel_bias, (accel_psd / kRate).cwiseSqrt());
    last = errors;
  }
  EXPECT_NEAR(gyro.value(), 1.0, gyro.tolerance());
  EXPECT_NEAR(accel.value(), 1.0, accel.tolerance());
}

TEST(SimImu, ABiasToldAsARandomWalkStartsAtItsTurnOnValueAndMovesAsSpecified) {
  NoiseSpec spec = test_spec();
  spec.gyro = convert_bias(spec.gyro, BiasKind::kRandomWalk, 0.0);
  ImuErrorConfig config;
  config.turn_on = false;
  ImuErrorModel model(spec, config, kRate, 8);
  MeanSquare gyro;
  ImuErrorModel::Errors last = model.next();
  EXPECT_EQ(last.gyro_bias, Eigen::Vector3d(0, 0, 0));
  for (int k = 0; k < 50000; ++k) {
    const ImuErrorModel::Errors errors = model.next();
    gyro.add(errors.gyro_bias - last.gyro_bias, spec.gyro.bias_random_walk / std::sqrt(kRate));
    last = errors;
  }
  EXPECT_NEAR(gyro.value(), 1.0, gyro.tolerance());
}

TEST(SimImu, BiasesAreStationaryFromTheFirstSampleOn) {
  const NoiseSpec spec = test_spec();
  ImuErrorConfig config;
  config.turn_on = false;
  const Eigen::Vector3d variance =
      0.5 * bias_psd(spec.gyro.bias_instability, spec.gyro.bias_time).cwiseProduct(spec.gyro.bias_time);
  MeanSquare first, later;
  double product = 0.0;
  constexpr double kSlowRate = 0.1;  // a sample every ten seconds [Hz]
  constexpr int kSteps = 3, kSeeds = 4000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    ImuErrorModel model(spec, config, kSlowRate, seed);
    const Eigen::Vector3d begin = model.next().gyro_bias;
    Eigen::Vector3d end = begin;
    for (int k = 0; k < kSteps; ++k) end = model.next().gyro_bias;
    first.add(begin, variance.cwiseSqrt());
    later.add(end, variance.cwiseSqrt());
    product += begin.cwiseProduct(end).cwiseQuotient(variance).sum() / (3.0 * kSeeds);
  }
  EXPECT_NEAR(first.value(), 1.0, first.tolerance());
  EXPECT_NEAR(later.value(), 1.0, later.tolerance());
  EXPECT_NEAR(product, std::exp(-kSteps / (kSlowRate * spec.gyro.bias_time.x())), later.tolerance());
}

TEST(SimImu, TurnOnBiasesAreConstantAndSpreadAsSpecified) {
  const NoiseSpec spec = test_spec();
  ImuErrorConfig config;
  config.bias_walk = false;
  MeanSquare spread;
  for (int seed = 0; seed < 4000; ++seed) {
    ImuErrorModel model(spec, config, kRate, seed);
    const Eigen::Vector3d first = model.next().accel_bias;
    ASSERT_EQ(model.next().accel_bias, first);
    spread.add(first, spec.accel.turn_on_bias);
  }
  EXPECT_NEAR(spread.value(), 1.0, spread.tolerance());
}

TEST(SimImu, SwitchingOneErrorOffLeavesTheOthersAlone) {
  const NoiseSpec spec = test_spec();
  ImuErrorConfig no_white;
  no_white.white = false;
  ImuErrorConfig no_walk;
  no_walk.bias_walk = false;
  ImuErrorModel all(spec, {}, kRate, 3), without_white(spec, no_white, kRate, 3), without_walk(spec, no_walk, kRate, 3);
  for (int k = 0; k < 100; ++k) {
    const ImuErrorModel::Errors a = all.next(), b = without_white.next(), c = without_walk.next();
    ASSERT_EQ(a.gyro_bias, b.gyro_bias);
    ASSERT_EQ(b.gyro_white, Eigen::Vector3d::Zero().eval());
    ASSERT_EQ(a.accel_white, c.accel_white);
    ASSERT_NE(a.accel_bias, c.accel_bias);
  }
}

TEST(SimImu, SamplesComeAtTheRateAndDependOnTheSeedAlone) {
  const SimTrajectory trajectory(make_scene("rooms").plan);
  constexpr TimeNs kStart = 1700000000 * kNsPerSecond;
  const auto run = [&](std::uint64_t seed) {
    return simulate_imu(trajectory, 6.0, kStart, kRate, test_spec(), {}, seed);
  };
  const SimulatedImu imu = run(1), same = run(1), other = run(2);
  ASSERT_EQ(imu.samples.size(), 1201u);
  EXPECT_EQ(imu.samples.back().stamp, kStart + 6 * kNsPerSecond);
  for (std::size_t k = 0; k < imu.samples.size(); ++k) {
    ASSERT_EQ(imu.samples[k].stamp, kStart + static_cast<TimeNs>(k) * 5000000);
    ASSERT_EQ(imu.samples[k].gyro, same.samples[k].gyro);
    ASSERT_EQ(imu.samples[k].accel, same.samples[k].accel);
    ASSERT_NE(imu.samples[k].accel, other.samples[k].accel);
  }
}

/// A hash taken before IMUs had defects, of readings in steps of 1e-10: what was simulated then must still be.
TEST(SimImu, RecordsWithoutDefectsAreTheSameAsEver) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](std::uint64_t word) {
    for (int i = 0; i < 8; ++i, word >>= 8) hash = (hash ^ (word & 255)) * 1099511628211ull;
  };
  const auto add_rounded = [&](double value) { add(static_cast<std::uint64_t>(std::llround(value * 1e10))); };
  const SimulatedImu imu = simulate_imu(SimTrajectory(fast_curve()), 4.0, kBoxStart, kRate, mti600_spec(), {}, 5);
  for (const ImuSample& sample : imu.samples) {
    add(static_cast<std::uint64_t>(sample.stamp));
    for (int axis = 0; axis < 3; ++axis) {
      add_rounded(sample.gyro[axis]);
      add_rounded(sample.accel[axis]);
    }
  }
  for (const auto* biases : {&imu.gyro_bias, &imu.accel_bias})
    for (const Eigen::Vector3d& bias : *biases)
      for (int axis = 0; axis < 3; ++axis) add_rounded(bias[axis]);
  EXPECT_EQ(hash, 0xa1f4172870cd6160u);
}

TEST(SimImu, RefusesARateOrABiasTimeThatIsNotPositive) {
  EXPECT_THROW(ImuErrorModel(test_spec(), {}, 0.0, 1), std::invalid_argument);
  NoiseSpec spec = test_spec();
  spec.accel.bias_time.y() = 0.0;
  EXPECT_THROW(ImuErrorModel(spec, {}, kRate, 1), std::invalid_argument);
}

TEST(SimRandom, NormalValuesHaveTheMomentsOfANormalDistribution) {
  constexpr int kCount = 200000;
  double mean = 0.0, square = 0.0, fourth = 0.0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double x = normal_from_bits(hash_bits(2 * i), hash_bits(2 * i + 1));
    mean += x / kCount;
    square += x * x / kCount;
    fourth += x * x * x * x / kCount;
  }
  EXPECT_NEAR(mean, 0.0, 4.0 / std::sqrt(kCount));
  EXPECT_NEAR(square, 1.0, 4.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth, 3.0, 4.0 * std::sqrt(96.0 / kCount));
}

}  // namespace
}  // namespace allan_lio
