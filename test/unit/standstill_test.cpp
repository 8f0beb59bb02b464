// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/standstill.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kStep = 0.005;                  // between readings [s]
constexpr double kGyroWhite = 1.2e-4;            // [rad/s/sqrt(Hz)]
constexpr double kAccelWhite = 6e-4;             // [m/s^2/sqrt(Hz)]
const Eigen::Vector3d kRate(3e-3, -2e-3, 1e-3);  // [rad/s]
const Eigen::Vector3d kForce(0.3, -0.2, 9.8);    // [m/s^2]
const Eigen::Vector3d kNone = Eigen::Vector3d::Zero();

NoiseSpec white_spec() {
  NoiseSpec spec;
  spec.gyro.white.setConstant(kGyroWhite);
  spec.accel.white.setConstant(kAccelWhite);
  return spec;
}

/// An IMU that reads its noise, `noise` times as much as its specification says, and a motion.
class Imu {
 public:
  explicit Imu(unsigned seed, double noise = 1.0) : random_(seed), noise_(noise / std::sqrt(kStep)) {}

  std::vector<ImuSample> record(double seconds) {
    std::vector<ImuSample> out;
    for (double t = 0.0; t < seconds; t += kStep) out.push_back(read(kNone, kNone));
    return out;
  }

  /// As the odometry has it: mean readings less the biases at hand.
  std::vector<TrackSegment> track(double seconds, const Eigen::Vector3d& rate, const Eigen::Vector3d& acceleration) {
    std::vector<TrackSegment> out;
    NavState state;
    state.gyro_bias << 1e-3, 2e-3, 3e-3;
    state.accel_bias << 0.1, 0.2, 0.3;
    for (double t = 0.5 * kStep; t < seconds; t += kStep) {
      const ImuSample sample = read(rate, acceleration);
      out.push_back({state, {kStep, sample.gyro - state.gyro_bias, sample.accel - state.accel_bias}});
    }
    return out;
  }

 private:
  ImuSample read(const Eigen::Vector3d& rate, const Eigen::Vector3d& acceleration) {
    const auto white = [this](double density) {
      return Eigen::Vector3d(Eigen::Vector3d::NullaryExpr([&] { return density * noise_ * normal_(random_); }));
    };
    stamp_ += to_ns(kStep);
    return {stamp_, kRate + rate + white(kGyroWhite), kForce + acceleration + white(kAccelWhite)};
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  double noise_;
  TimeNs stamp_ = 0;
};

TEST(Standstill, LastsForAsLongAsTheImuReadsItsNoise) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    Imu imu(seed);
    Standstill standstill;
    standstill.begin(imu.record(1.0), white_spec());
    for (int i = 0; i < 600; ++i) standstill.go_on(imu.track(0.1, kNone, kNone));
    EXPECT_TRUE(standstill.lasts()) << "seed " << seed;
  }
}

TEST(Standstill, EndsWithAPushOrATurn) {
  // A hundredth of g, and half a degree a second: five times what a mean over a scan may deviate by.
  const struct {
    Eigen::Vector3d rate, acceleration;
  } motions[] = {{kNone, {0.1, 0, 0}}, {kNone, {0, -0.1, 0}}, {{0, 0, 0.009}, kNone}, {{-0.009, 0, 0}, kNone}};
  for (const auto& motion : motions) {
    Imu imu(1);
    Standstill standstill;
    standstill.begin(imu.record(1.0), white_spec());
    for (int i = 0; i < 50; ++i) standstill.go_on(imu.track(0.1, kNone, kNone));
    ASSERT_TRUE(standstill.lasts());
    standstill.go_on(imu.track(0.1, motion.rate, motion.acceleration));
    EXPECT_FALSE(standstill.lasts());
    standstill.go_on(imu.track(0.1, kNone, kNone));
    EXPECT_FALSE(standstill.lasts()) << "it began to last again";
  }
}

TEST(Standstill, FollowsABiasThatDrifts) {
  Imu imu(3);
  Standstill standstill;
  standstill.begin(imu.record(1.0), white_spec());
  for (int i = 0; i < 6000; ++i)  // ten minutes, over which the bias moves by ten times what a mean may deviate by
    standstill.go_on(imu.track(0.1, {4e-3 * i / 6000.0 * 5.0, 0, 0}, kNone));
  EXPECT_TRUE(standstill.lasts());
}

TEST(Standstill, EndsWithAMotionThatCameAndWentBetweenTwoScans) {
  Imu imu(4);
  Standstill standstill;
  standstill.begin(imu.record(1.0), white_spec());
  std::vector<TrackSegment> track = imu.track(0.6, kNone, kNone);
  standstill.go_on(track);
  ASSERT_TRUE(standstill.lasts());
  for (const double push : {0.3, -0.3})
    for (const TrackSegment& segment : imu.track(0.2, kNone, {push, 0, 0})) track.push_back(segment);
  standstill.go_on(track);
  EXPECT_FALSE(standstill.lasts());
}

TEST(Standstill, EndsWithAGapInTheReadings) {
  Imu imu(5);
  Standstill standstill;
  standstill.begin(imu.record(1.0), white_spec());
  std::vector<TrackSegment> track = imu.track(0.1, kNone, kNone);
  track[5].interval.dt = 0.15;
  standstill.go_on(track);
  EXPECT_FALSE(standstill.lasts());
}

TEST(Standstill, IsNotWatchedWhereTheImuReadsMoreThanNoise) {
  for (const double noise : {2.0, 5.0}) {
    Imu imu(2, noise);
    Standstill standstill;
    standstill.begin(imu.record(1.0), white_spec());
    EXPECT_EQ(standstill.lasts(), noise < 3.0);
  }
  Standstill never;
  EXPECT_FALSE(never.lasts());
}

TEST(UpdateStandstill, TellsPoseVelocityAndWhatGoesWithThem) {
  // Attitude and gyro bias after a tenth of a second without it: as far as the bias has turned it.
  LioState state;
  state.nav.T_world_imu.rotation = exp_so3({0.1, 0.2, 0.3});
  const RigidTransform start = state.nav.T_world_imu;
  state.nav.T_world_imu.rotation = state.nav.T_world_imu.rotation * exp_so3({-1e-3, 0.0, 0.0});
  state.nav.T_world_imu.translation << 0.0, 2e-3, 0.0;
  state.nav.velocity_world << 0.0, 0.04, 0.0;
  constexpr double kBias = 1e-2, kVelocity2 = 0.02 * 0.02, kTime = 0.1, kSway = 1e-4, kVelocitySway = 2e-3;
  Belief belief;
  belief.covariance(kTheta, kTheta) = kBias * kBias * kTime * kTime;
  belief.covariance(kGyroBias, kGyroBias) = kBias * kBias;
  belief.covariance(kTheta, kGyroBias) = belief.covariance(kGyroBias, kTheta) = -kBias * kBias * kTime;
  belief.covariance(kVelocity + 1, kVelocity + 1) = kVelocity2;
  belief.covariance(kPosition + 1, kPosition + 1) = 1e-6;
  AbsoluteCovariance absolute;
  absolute.reset(belief.covariance);
  ASSERT_TRUE(update_standstill(start, false, state, belief, absolute));
  const double rotation = kBias * kBias * kTime * kTime, gain = rotation / (rotation + kSway * kSway);
  EXPECT_NEAR(state.nav.gyro_bias.x(), -gain * 1e-3 / kTime, 1e-6);
  EXPECT_NEAR(log_so3(start.rotation.conjugate() * state.nav.T_world_imu.rotation).x(), -(1.0 - gain) * 1e-3, 1e-8);
  EXPECT_NEAR(state.nav.velocity_world.y(), 0.04 * (1.0 - kVelocity2 / (kVelocity2 + kVelocitySway * kVelocitySway)),
              1e-9);
  EXPECT_NEAR(state.nav.T_world_imu.translation.y(), 1e-3, 1e-9);
  EXPECT_NEAR(belief.covariance(kTheta, kTheta), kSway * kSway * gain, 1e-12);
  EXPECT_NEAR(belief.covariance(kGyroBias, kGyroBias), kBias * kBias * (1.0 - gain), 1e-9);
  EXPECT_LT((absolute.state() - belief.covariance).norm(), 1e-12);
}

TEST(UpdateStandstill, TheFirstOneTellsNothingOfWhatTheSameReadingsHaveTold) {
  LioState state;
  state.nav.T_world_imu.rotation = exp_so3({-1e-3, 0.0, 0.0});
  state.nav.velocity_world << 0.0, 0.02, 0.0;
  Belief belief;
  belief.covariance.diagonal().setConstant(1e-4);
  belief.covariance(kTheta, kGyroBias) = belief.covariance(kGyroBias, kTheta) = -9e-5;
  belief.view.cross(kTheta, 0) = 1e-5;
  AbsoluteCovariance absolute;
  absolute.reset(belief.covariance);
  ASSERT_TRUE(update_standstill(RigidTransform(), true, state, belief, absolute));
  EXPECT_LT(state.nav.T_world_imu.rotation.angularDistance(Eigen::Quaterniond::Identity()), 1e-9);
  EXPECT_EQ(state.nav.velocity_world.norm(), 0.0);
  EXPECT_EQ(state.nav.gyro_bias.norm(), 0.0);
  EXPECT_DOUBLE_EQ(belief.covariance(kGyroBias, kGyroBias), 1e-4);
  EXPECT_NEAR(belief.covariance(kTheta, kTheta), 1e-8, 1e-13);
  EXPECT_EQ(belief.covariance(kTheta, kGyroBias), 0.0);
  EXPECT_EQ(belief.view.cross(kTheta, 0), 0.0);
  EXPECT_LT((absolute.state() - belief.covariance).norm(), 1e-12);
}

TEST(UpdateStandstill, LeavesAFilterAloneThatDoesNotKnowItsVelocity) {
  LioState state;
  Belief belief;
  belief.covariance(kVelocity + 2, kVelocity + 2) = 0.2 * 0.2;
  AbsoluteCovariance absolute;
  EXPECT_FALSE(update_standstill(RigidTransform(), false, state, belief, absolute))
      << "it may be a steady ride in a tunnel";
}

TEST(UpdateStandstill, LeavesAFilterAloneThatKnowsOfAMotion) {
  LioState state;
  state.nav.velocity_world << 0.3, 0.0, 0.0;
  state.nav.T_world_imu.translation << 0.3, 0.0, 0.0;
  Belief belief;
  belief.covariance.diagonal().setConstant(1e-4);
  AbsoluteCovariance absolute;
  absolute.reset(belief.covariance);
  const LioMatrix before = belief.covariance;
  EXPECT_FALSE(update_standstill(RigidTransform(), false, state, belief, absolute));
  EXPECT_EQ(state.nav.velocity_world.x(), 0.3);
  EXPECT_EQ(belief.covariance, before);
  EXPECT_EQ(absolute.state(), before);
}

}  // namespace
}  // namespace allan_lio
