// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/propagate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRounding = 1e-12;  // of a few hundred steps over metres

NavState start() {
  NavState x;
  x.stamp = 1'600'000'000'000'000'001;
  x.T_world_imu = {exp_so3({0.4, -1.1, 2.0}), {10, -3, 2}};
  x.velocity_world << 1, 2, -0.5;
  return x;
}

ImuInterval interval(double dt, const Eigen::Vector3d& gyro, const Eigen::Vector3d& accel) {
  ImuInterval result;
  result.dt = dt;
  result.gyro = gyro;
  result.accel = accel;
  return result;
}

/// Largest difference of rotation [rad], position [m] and velocity [m/s].
double distance(const NavState& a, const NavState& b) { return nav_minus(a, b).head<9>().cwiseAbs().maxCoeff(); }

/// R' = R skew(w), v' = g + R a, p' = v by the classical Runge-Kutta method, rotation as a matrix.
NavState integrate_finely(const NavState& x, const ImuInterval& motion, int steps) {
  Eigen::Matrix3d r = x.T_world_imu.rotation.toRotationMatrix();
  Eigen::Vector3d v = x.velocity_world, p = x.T_world_imu.translation;
  const Eigen::Matrix3d w = skew(motion.gyro);
  const double h = motion.dt / steps;
  const auto acceleration = [&](const Eigen::Matrix3d& rotation) -> Eigen::Vector3d {
    return x.gravity_world + rotation * motion.accel;
  };
  for (int i = 0; i < steps; ++i) {
    const Eigen::Matrix3d k1 = r * w, k2 = (r + 0.5 * h * k1) * w, k3 = (r + 0.5 * h * k2) * w, k4 = (r + h * k3) * w;
    const Eigen::Vector3d a1 = acceleration(r), a2 = acceleration(r + 0.5 * h * k1),
                          a3 = acceleration(r + 0.5 * h * k2), a4 = acceleration(r + h * k3);
    p += h * v + h * h / 6.0 * (a1 + a2 + a3);
    v += h / 6.0 * (a1 + 2 * a2 + 2 * a3 + a4);
    r += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  NavState y = x;
  y.T_world_imu = {Eigen::Quaterniond(r).normalized(), p};
  y.velocity_world = v;
  return y;
}

TEST(Propagate, FreeFallIsAParabola) {
  const NavState x = start();
  NavState y = x;
  for (int i = 0; i < 200; ++i) y = propagate_mean(y, interval(0.01, {0.3, 0.2, -1}, {0, 0, 0}), ImuNoise{});
  const double t = 2.0;
  EXPECT_LT((y.velocity_world - (x.velocity_world + t * x.gravity_world)).norm(), kRounding);
  EXPECT_LT(
      (y.T_world_imu.translation - (x.T_world_imu.translation + t * x.velocity_world + 0.5 * t * t * x.gravity_world))
          .norm(),
      kRounding);
}

TEST(Propagate, RestStaysAtRest) {
  NavState x = start();
  x.velocity_world.setZero();
  const Eigen::Vector3d specific_force = x.T_world_imu.rotation.conjugate() * -x.gravity_world;
  NavState y = x;
  for (int i = 0; i < 1000; ++i) y = propagate_mean(y, interval(0.005, {0, 0, 0}, specific_force), ImuNoise{});
  EXPECT_LT(distance(y, x), kRounding);
}

TEST(Propagate, ConstantRateAndSpecificForceAgreeWithFineIntegrationInOneStep) {
  for (const double rate : {0.0, 1e-9, 1e-3, 0.49, 0.51, 2.0, 6.0}) {
    const ImuInterval motion = interval(1.0, rate * Eigen::Vector3d(0.48, -0.6, 0.64), {1.0, -2.0, 9.0});
    const NavState fine = integrate_finely(start(), motion, 4000);
    EXPECT_LT(distance(propagate_mean(start(), motion, ImuNoise{}), fine), 1e-10) << "rate " << rate;
  }
}

TEST(Propagate, ACircleClosesOnItself) {
  const double speed = 3.0, rate = 0.7;  // [m/s], [rad/s]
  NavState x;
  x.velocity_world << speed, 0, 0;
  const Eigen::Vector3d specific_force(0, speed * rate, -x.gravity_world.z());
  constexpr int kSteps = 400;
  NavState y = x;
  for (int i = 0; i < kSteps / 2; ++i)
    y = propagate_mean(y, interval(2 * kPi / rate / kSteps, {0, 0, rate}, specific_force), ImuNoise{});
  EXPECT_LT((y.T_world_imu.translation - Eigen::Vector3d(0, 2 * speed / rate, 0)).norm(), kRounding * 10);
  EXPECT_LT((y.velocity_world - Eigen::Vector3d(-speed, 0, 0)).norm(), kRounding);
  for (int i = kSteps / 2; i < kSteps; ++i)
    y = propagate_mean(y, interval(2 * kPi / rate / kSteps, {0, 0, rate}, specific_force), ImuNoise{});
  EXPECT_LT(distance(y, x), kRounding * 10);
}

TEST(Propagate, AnIntervalSplitInTwoEqualsTheWhole) {
  const Eigen::Vector3d gyro(0.5, -2.0, 1.0), accel(1, -2, 9);
  const NavState whole = propagate_mean(start(), interval(0.1, gyro, accel), ImuNoise{});
  for (const double at : {1e-6, 0.03, 0.05, 0.0999}) {
    const NavState first = propagate_mean(start(), interval(at, gyro, accel), ImuNoise{});
    EXPECT_LT(distance(propagate_mean(first, interval(0.1 - at, gyro, accel), ImuNoise{}), whole), kRounding);
  }
}

TEST(Propagate, TheStampAdvancesByTheIntervalToTheNanosecond) {
  ImuSample from, to;
  from.stamp = start().stamp;
  to.stamp = from.stamp + 2'500'001;
  const ImuInterval between = mean_interval(start(), from, to);
  EXPECT_DOUBLE_EQ(between.dt, 0.002500001);
  EXPECT_EQ(propagate_mean(start(), between, ImuNoise{}).stamp, to.stamp);
  for (const TimeNs step : {TimeNs{1}, TimeNs{4'999'999}, TimeNs{100'000'000}, TimeNs{3'600'000'000'001}}) {
    to.stamp = from.stamp + step;
    EXPECT_EQ(propagate_mean(start(), mean_interval(start(), from, to), ImuNoise{}).stamp, to.stamp);
  }
  EXPECT_EQ(propagate_mean(start(), interval(0.0024999999997, {0, 0, 0}, {0, 0, 9}), ImuNoise{}).stamp,
            start().stamp + 2'500'000)
      << "rounded, not cut";
}

TEST(Propagate, TheMeanReadingIsTakenAndTheBiasesAreTakenOff) {
  NavState x = start();
  x.gyro_bias << 0.1, 0.2, 0.3;
  x.accel_bias << -1, -2, -3;
  ImuSample from, to;
  to.stamp = kNsPerSecond / 100;
  from.gyro << 1, 2, 3;
  to.gyro << 3, 2, 1;
  from.accel << 0, 0, 9;
  to.accel << 2, 4, 11;
  const ImuInterval mean = mean_interval(x, from, to);
  EXPECT_LT((mean.gyro - Eigen::Vector3d(1.9, 1.8, 1.7)).norm(), kRounding);
  EXPECT_LT((mean.accel - Eigen::Vector3d(2, 4, 13)).norm(), kRounding);
}

TEST(Propagate, RandomWalkBiasesStayAndGaussMarkovBiasesDecay) {
  NavState x = start();
  x.gyro_bias << 0.1, 0.2, 0.3;
  x.accel_bias << -1, -2, -3;
  ImuNoise noise;
  const ImuInterval motion = interval(0.5, {0, 0, 1}, {0, 0, 9});
  EXPECT_EQ(propagate_mean(x, motion, noise).gyro_bias, x.gyro_bias);
  EXPECT_EQ(propagate_mean(x, motion, noise).accel_bias, x.accel_bias);
  noise.gyro_bias_rate << 0.0, 0.5, 2.0;
  noise.accel_bias_rate << 1.0, 0.0, 0.1;
  const NavState y = propagate_mean(x, motion, noise);
  EXPECT_LT((y.gyro_bias - Eigen::Vector3d(0.1, 0.2 * std::exp(-0.25), 0.3 * std::exp(-1.0))).norm(), kRounding);
  EXPECT_LT((y.accel_bias - Eigen::Vector3d(-std::exp(-0.5), -2, -3 * std::exp(-0.05))).norm(), kRounding);
  // About a mean.
  NavState about = x;
  about.gyro_bias_mean << 1.0, 2.0, 3.0;
  about.gyro_bias += about.gyro_bias_mean;
  EXPECT_LT((propagate_mean(about, motion, noise).gyro_bias - about.gyro_bias_mean - y.gyro_bias).norm(), kRounding);
  EXPECT_EQ(propagate_mean(about, motion, noise).gyro_bias_mean, about.gyro_bias_mean);
}

TEST(Propagate, GravityNeverChanges) {
  const NavState y = propagate_mean(start(), interval(0.1, {1, 2, 3}, {4, 5, 6}), ImuNoise{});
  EXPECT_EQ(y.gravity_world, start().gravity_world);
}

}  // namespace
}  // namespace allan_lio
