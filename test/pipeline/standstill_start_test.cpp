// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A start from a standstill that lasts for longer than the record from which the filter starts.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/math/so3.h"
#include "room_stand.h"
#include "simulated_drive.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

RigidTransform truth_at(const SimulatedDrive& drive, TimeNs stamp) {
  const auto after = std::lower_bound(drive.truth.begin(), drive.truth.end(), stamp,
                                      [](const StampedPose& pose, TimeNs value) { return pose.stamp < value; });
  return after == drive.truth.end() ? drive.truth.back().pose : after->pose;
}

double speed_at(const SimulatedDrive& drive, TimeNs stamp) {
  const Eigen::Vector3d moved = truth_at(drive, stamp).translation - truth_at(drive, stamp - to_ns(0.02)).translation;
  return moved.norm() / 0.02;
}

/// By how much the attitude errs, as seen from the first pose [rad].
double attitude_error(const SimulatedDrive& drive, const LioResult& first, const LioResult& now) {
  const auto turned = [](const Eigen::Quaterniond& from, const Eigen::Quaterniond& to) {
    return (from.conjugate() * to).normalized();
  };
  const TimeNs begin = first.state.nav.stamp, end = now.state.nav.stamp;
  return turned(truth_at(drive, begin).rotation, truth_at(drive, end).rotation)
      .angularDistance(turned(first.state.nav.T_world_imu.rotation, now.state.nav.T_world_imu.rotation));
}

// On flat ground a standing LiDAR sees mere rings, no plane: the filter had to dead-reckon its standstill, and the map
// was founded by as much aside as the gyroscope had drifted by then.
TEST(StandstillStart, OnFlatGroundTheAttitudeDoesNotDriftWhileTheRobotStands) {
  constexpr double kDuration = 4.0, kStands = 1e-3, kGoes = 0.05;  // [s], [m/s]
  double held = 0.0, free = 0.0;
  constexpr std::uint64_t kSeeds = 3;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedDrive drive = simulate_drive("field", kDuration, seed);
    LioConfig config = simulated_robot();
    const std::vector<LioResult> with = run_odometry(drive, config);
    config.init.hold_standstill = false;
    const std::vector<LioResult> without = run_odometry(drive, config);
    std::size_t last = 0;
    for (std::size_t i = 0; i < with.size(); ++i) {
      EXPECT_FALSE(without[i].standing);
      const double speed = speed_at(drive, with[i].state.nav.stamp);
      if (speed > kGoes) EXPECT_FALSE(with[i].standing) << "at " << speed << " m/s, scan " << i;
      if (speed < kStands && i >= 10) EXPECT_TRUE(with[i].standing) << "scan " << i;
      if (with[i].standing) last = i;
    }
    ASSERT_GT(last, 20U);
    held += std::pow(attitude_error(drive, with[0], with[last]), 2);
    free += std::pow(attitude_error(drive, without[0], without[last]), 2);
    const LioMatrix& p = with[last].covariance;
    EXPECT_LT(std::sqrt(p(kTheta, kTheta)), 1e-4);
    EXPECT_LT(p(kGyroBias, kGyroBias), 0.7 * without[last].covariance(kGyroBias, kGyroBias));
  }
  held = std::sqrt(held / kSeeds), free = std::sqrt(free / kSeeds);
  RecordProperty("held_urad", static_cast<int>(1e6 * held));
  RecordProperty("free_urad", static_cast<int>(1e6 * free));
  EXPECT_LT(held, 1e-4) << "free: " << free;
  EXPECT_GT(free, 2.0 * held);
}

// The first second's readings are in the record that the filter starts from and must not be believed a second time
// (NEES 1.8 if they are).
TEST(StandstillStart, TheGyrosBiasIsAsWellKnownAsTheCovarianceSays) {
  constexpr double kGyroWhite = 1.2e-4, kAccelWhite = 6e-4;  // [rad/s/sqrt(Hz)], [m/s^2/sqrt(Hz)]
  constexpr int kRuns = 80, kScans[] = {12, 25};
  LioConfig config = simulated_robot();
  config.lidar.min_points = 1;
  config.imu.spec.gyro.white.setConstant(kGyroWhite);
  config.imu.spec.accel.white.setConstant(kAccelWhite);
  double nees[] = {0.0, 0.0};
  for (unsigned run = 0; run < kRuns; ++run) {
    std::mt19937 random(run);
    std::normal_distribution<double> normal(0.0, 1.0 / std::sqrt(1e-9 * kImuStep));
    const auto noise = [&](double density) {
      return Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return density * normal(random); }));
    };
    const Eigen::Vector3d bias(2e-3, -1e-3, 3e-3);
    const auto no_plane = [](int) { return std::optional<std::vector<Eigen::Vector3d>>(room_points(30, 0.02, 1)); };
    const auto add_noise = [&](ImuSample& sample) {
      sample.gyro += bias + noise(kGyroWhite);
      sample.accel += noise(kAccelWhite);
      return true;
    };
    const Drive rest = stand(config, 30, no_plane, add_noise);
    for (int i = 0; i < 2; ++i) {
      const LioResult& at = rest.results[static_cast<std::size_t>(kScans[i])];
      ASSERT_TRUE(at.standing);
      const Eigen::Vector3d error = at.state.nav.gyro_bias - bias;
      nees[i] += error.dot(at.covariance.block<3, 3>(kGyroBias, kGyroBias).inverse() * error) / (3.0 * kRuns);
    }
  }
  for (const double mean : nees) {  // of 240 degrees of freedom: 4 sigma are 0.37
    EXPECT_GT(mean, 0.6);
    EXPECT_LT(mean, 1.4);
  }
}

// A steady ride feels the same to the IMU; the LiDAR tells it within the first second.
TEST(StandstillStart, ASlowSteadyRideIsNotHeld) {
  constexpr double kStep = 0.02;  // [m] a scan: 0.2 m/s
  const Drive ride = stand(simulated_robot(), 60, [](int i) {
    std::vector<Eigen::Vector3d> points = room(i);
    for (Eigen::Vector3d& p : points) p.x() -= kStep * i;
    return std::optional<std::vector<Eigen::Vector3d>>(points);
  });
  for (std::size_t i = 0; i < ride.results.size(); ++i) {
    EXPECT_FALSE(ride.results[i].standing) << "scan " << i;
  }
  EXPECT_NEAR(ride.results.back().state.nav.velocity_world.norm(), kStep / 0.1, 0.01);
}

TEST(StandstillStart, ARobotThatStandsInARoomIsHeld) {
  const Drive rest =
      stand(simulated_robot(), 60, [](int i) { return std::optional<std::vector<Eigen::Vector3d>>(room(i)); });
  EXPECT_TRUE(rest.results.back().standing);
  EXPECT_LT(strayed(rest.results.back()), 2e-3);
}

// What deskewing errs by is correlated with the state at the scan's end, and no longer is once that is held.
TEST(StandstillStart, TheCovarianceStaysOneHoweverLargeTheNoise) {
  LioConfig config = default_config(mti600_spec());
  config.imu.scale.k_g = config.imu.scale.k_a = 30.0;
  const auto here = [](int i) { return std::optional<std::vector<Eigen::Vector3d>>(room(i)); };
  for (const LioResult& result : stand(config, 40, here).results) {
    const Eigen::SelfAdjointEigenSolver<LioMatrix> eigen(result.covariance, Eigen::EigenvaluesOnly);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-12);
  }
}

TEST(StandstillStart, IsNotHeldWhereTheImusPoseIsUncertainWithTheExtrinsics) {
  LioConfig config = simulated_robot();
  config.estimate_extrinsics = true;
  const auto here = [](int i) { return std::optional<std::vector<Eigen::Vector3d>>(room(i)); };
  EXPECT_FALSE(stand(config, 30, here).results.back().standing);
}

}  // namespace
}  // namespace allan_lio
