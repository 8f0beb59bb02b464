// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/state_propagator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1600000000 * kNsPerSecond;
constexpr TimeNs kStep = 5'000'000;  // [ns]
constexpr double kGravity = 9.80665;
constexpr double kRounding = 1e-12;

ImuSample sample_at(int i) {
  const double t = 1e-9 * static_cast<double>(kStep) * i;
  return {kStart + i * kStep, {0.3, -0.2, std::sin(t)}, {std::cos(3 * t), 0.5, kGravity}};
}

ImuNoise some_noise() {
  ImuNoise noise;
  noise.gyro_psd.setConstant(1e-7);
  noise.accel_psd.setConstant(1e-6);
  noise.gyro_bias_psd.setConstant(1e-11);
  noise.accel_bias_psd.setConstant(1e-10);
  return noise;
}

NavState state_at(TimeNs stamp) {
  NavState state;
  state.stamp = stamp;
  state.velocity_world = {1.0, 0.5, 0.0};
  state.gyro_bias = {0.01, 0.0, -0.01};
  return state;
}

const NavMatrix kStartCovariance = 1e-4 * NavMatrix::Identity();

void expect_same(const StatePropagator& a, const StatePropagator& b) {
  EXPECT_EQ(a.estimate().state.stamp, b.estimate().state.stamp);
  EXPECT_LT(nav_minus(a.estimate().state, b.estimate().state).norm(), kRounding);
  EXPECT_LT((a.estimate().covariance - b.estimate().covariance).norm(), kRounding);
}

TEST(StatePropagator, a_late_correction_gives_what_a_prompt_one_gives) {
  constexpr int kSamples = 60, kCorrection = 20;
  const TimeNs stamp = kStart + kCorrection * kStep + 2'000'000;  // between two samples
  StatePropagator prompt({Discretization::kTrapezoid, {}}), late({Discretization::kTrapezoid, {}});
  for (int i = 0; i < kSamples; ++i) {
    prompt.add(sample_at(i));
    late.add(sample_at(i));
    if (i == kCorrection + 1) prompt.restart(state_at(stamp), kStartCovariance, some_noise(), 1.0);
  }
  late.restart(state_at(stamp), kStartCovariance, some_noise(), 1.0);
  expect_same(prompt, late);
  EXPECT_EQ(late.estimate().state.stamp, sample_at(kSamples - 1).stamp);
}

TEST(StatePropagator, follows_the_equations_of_the_filter) {
  StatePropagator propagator({Discretization::kVanLoan, {}});
  propagator.add(sample_at(0));
  propagator.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
  ASSERT_TRUE(propagator.add(sample_at(1)));
  const ImuInterval interval = mean_interval(state_at(kStart), sample_at(0), sample_at(1));
  const DiscreteModel model = discretize(state_at(kStart), interval, some_noise(), Discretization::kVanLoan);
  const NavMatrix expected = model.phi * kStartCovariance * model.phi.transpose() + model.q;
  EXPECT_LT((propagator.estimate().covariance - expected).norm(), kRounding);
  const NavState moved = propagate_mean(state_at(kStart), interval, some_noise());
  EXPECT_LT(nav_minus(propagator.estimate().state, moved).norm(), kRounding);
}

TEST(StatePropagator, readings_in_g_are_scaled) {
  StatePropagator metric({Discretization::kTrapezoid, {}}), in_g({Discretization::kTrapezoid, {}});
  for (int i = 0; i < 30; ++i) {
    ImuSample sample = sample_at(i);
    metric.add(sample);
    sample.accel /= kGravity;
    in_g.add(sample);
    if (i != 3) continue;
    metric.restart(state_at(sample.stamp), kStartCovariance, some_noise(), 1.0);
    in_g.restart(state_at(sample.stamp), kStartCovariance, some_noise(), kGravity);
  }
  expect_same(metric, in_g);
}

TEST(StatePropagator, gives_nothing_before_the_first_correction_nor_for_bad_samples) {
  StatePropagator propagator({Discretization::kTrapezoid, {}});
  EXPECT_FALSE(propagator.add(sample_at(0)));
  propagator.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
  EXPECT_TRUE(propagator.add(sample_at(1)));
  EXPECT_FALSE(propagator.add(sample_at(1)));
  EXPECT_FALSE(propagator.add(sample_at(0)));
  ImuSample broken = sample_at(2);
  broken.gyro.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(propagator.add(broken));
  EXPECT_TRUE(propagator.add(sample_at(2)));
  propagator.clear();
  EXPECT_FALSE(propagator.add(sample_at(0)));
}

TEST(StatePropagator, an_absurd_reading_and_a_stamp_from_the_future_change_nothing) {
  constexpr int kSamples = 20, kBad = 10;
  StatePropagator clean({Discretization::kTrapezoid, {}}), fed({Discretization::kTrapezoid, {}});
  for (int i = 0; i < kSamples; ++i) {
    EXPECT_EQ(clean.add(sample_at(i)), fed.add(sample_at(i))) << i;
    if (i == 2) clean.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
    if (i == 2) fed.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
    if (i != kBad) continue;
    ImuSample absurd = sample_at(i);
    absurd.stamp += kStep / 2;
    absurd.accel.x() = -1e4;
    EXPECT_FALSE(fed.add(absurd));
    ImuSample ahead = sample_at(i);
    ahead.stamp += 1000 * kNsPerSecond;
    EXPECT_FALSE(fed.add(ahead));
  }
  expect_same(clean, fed);
}

/// `sample` with a reading of so many g along x, by a sensor of that unit [m/s^2].
ImuSample pushed(ImuSample sample, double g, double unit) {
  sample.accel = Eigen::Vector3d(g * kGravity / unit, 0, 0);
  return sample;
}

TEST(StatePropagator, fifty_g_are_the_limit_in_either_unit) {
  for (const double unit : {1.0, kGravity}) {
    StatePropagator propagator({Discretization::kTrapezoid, {}});
    propagator.add(pushed(sample_at(0), 1, unit));
    propagator.restart(state_at(kStart), kStartCovariance, some_noise(), unit);
    EXPECT_FALSE(propagator.add(pushed(sample_at(1), 51, unit))) << unit;
    EXPECT_TRUE(propagator.add(pushed(sample_at(1), 49, unit))) << unit;
  }
}

TEST(StatePropagator, a_reading_that_came_before_the_unit_was_known_is_judged_by_it) {
  StatePropagator clean({Discretization::kTrapezoid, {}}), fed({Discretization::kTrapezoid, {}});
  for (int i = 0; i < 10; ++i) {
    clean.add(pushed(sample_at(i), 1, kGravity));
    fed.add(pushed(sample_at(i), 1, kGravity));
    ImuSample between = sample_at(i);
    between.stamp += kStep / 2;
    if (i == 5) fed.add(pushed(between, 51, kGravity));
  }
  clean.restart(state_at(kStart), kStartCovariance, some_noise(), kGravity);
  fed.restart(state_at(kStart), kStartCovariance, some_noise(), kGravity);
  expect_same(clean, fed);
}

TEST(StatePropagator, a_gap_and_a_saturated_reading_widen_the_covariance_as_the_filters) {
  constexpr int kGapSamples = 100;  // 0.5 s
  const StatePropagator::Options options{Discretization::kTrapezoid, {0.35, 100.0}};
  const auto after = [&](int last) {
    StatePropagator propagator(options);
    propagator.add(sample_at(0));
    propagator.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
    EXPECT_TRUE(propagator.add(sample_at(last)));
    return propagator.estimate().covariance;
  };
  const auto by_equations = [&](int last) {
    const ImuSample from = sample_at(0), to = sample_at(last);
    const ImuNoise noise = noise_between(some_noise(), options.range, from, to, seconds_between(from.stamp, to.stamp));
    const DiscreteModel model =
        discretize(state_at(kStart), mean_interval(state_at(kStart), from, to), noise, options.discretization);
    return NavMatrix(model.phi * kStartCovariance * model.phi.transpose() + model.q);
  };
  EXPECT_LT((after(kGapSamples) - by_equations(kGapSamples)).norm(), kRounding);
  // 0.5 rad/s and 2 m/s^2 for 0.5 s in one direction.
  const double turned = std::sqrt((after(kGapSamples) - kStartCovariance)(0, 0));
  EXPECT_GT(turned, 0.9 * 0.5 * 0.5);
  EXPECT_LT(turned, 1.5 * 0.5 * 0.5);
  const int saturating = 72;  // sin(0.36) > 0.35, the first and only one
  const auto stepwise = [&](double range) {
    StatePropagator propagator({Discretization::kTrapezoid, {range, 100.0}});
    propagator.add(sample_at(0));
    propagator.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
    for (int i = 1; i <= saturating; ++i) propagator.add(sample_at(i));
    return propagator.estimate().covariance(0, 0);
  };
  const double missed = 0.2 * 0.35 * 1e-9 * static_cast<double>(kStep);  // [rad], 1 sigma
  EXPECT_NEAR(stepwise(0.35) - stepwise(10.0), missed * missed, 0.02 * missed * missed);
}

TEST(StatePropagator, follows_limits_that_change) {
  StatePropagator changed({Discretization::kTrapezoid, {10.0, 100.0}});
  StatePropagator always({Discretization::kTrapezoid, {0.1, 1.0}, 0.3});
  changed.set_limits({0.1, 1.0}, 0.3);
  for (StatePropagator* propagator : {&changed, &always}) {
    propagator->add(sample_at(0));
    propagator->restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
    for (int i = 1; i < 20; ++i) propagator->add(sample_at(i));
  }
  EXPECT_EQ(changed.estimate().covariance, always.estimate().covariance);
  EXPECT_FALSE(changed.add(sample_at(100)));
}

TEST(StatePropagator, waits_for_a_correction_after_a_silence_that_is_too_long_to_bridge) {
  StatePropagator propagator({Discretization::kTrapezoid, {}, 0.3});
  propagator.add(sample_at(0));
  propagator.restart(state_at(kStart), kStartCovariance, some_noise(), 1.0);
  EXPECT_TRUE(propagator.add(sample_at(50)));
  EXPECT_FALSE(propagator.add(sample_at(120)));
  EXPECT_FALSE(propagator.add(sample_at(121)));
  propagator.restart(state_at(kStart + 120 * kStep), kStartCovariance, some_noise(), 1.0);
  EXPECT_TRUE(propagator.add(sample_at(122)));
  EXPECT_DOUBLE_EQ(propagator.sample_interval(), 0.005);
}

TEST(StatePropagator, a_correction_ahead_of_the_samples_waits_for_them) {
  StatePropagator propagator({Discretization::kTrapezoid, {}});
  propagator.add(sample_at(0));
  propagator.restart(state_at(kStart + 3 * kStep), kStartCovariance, some_noise(), 1.0);
  EXPECT_FALSE(propagator.add(sample_at(1)));
  EXPECT_FALSE(propagator.add(sample_at(3)));
  EXPECT_TRUE(propagator.add(sample_at(4)));
  EXPECT_EQ(propagator.estimate().state.stamp, sample_at(4).stamp);
}

}  // namespace
}  // namespace allan_lio
