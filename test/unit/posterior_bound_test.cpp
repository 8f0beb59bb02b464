// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/posterior_bound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "allan_lio/eval/consistency_report.h"
#include "allan_lio/eval/dead_reckoning.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1'700'000'000 * kNsPerSecond, kStep = kNsPerSecond / 50;
constexpr double kGravityLength = 9.80665;
const AxisChoice kAlongX{AxisKind::kGiven, Eigen::Vector3d::UnitX()}, kMotion{AxisKind::kMotion, {}},
    kGround{AxisKind::kWeakest, {}};

using Way = std::function<RigidTransform(double)>;

Trajectory along(const Way& way, double seconds) {
  Trajectory truth;
  for (int i = 0; i * kStep <= to_ns(seconds); ++i) truth.push_back({kStart + i * kStep, way(0.02 * i)});
  return truth;
}

RigidTransform straight(double t) { return {Eigen::Quaterniond::Identity(), {7.0 * t, 0.0, 0.0}}; }

/// At 7 m/s on a circle so wide that its centripetal acceleration hardly tells the speed.
RigidTransform bend(double t) {
  constexpr double kRadius = 2000.0;  // [m]
  const double angle = 7.0 * t / kRadius;
  return {exp_so3({0.0, 0.0, angle}), {kRadius * std::sin(angle), kRadius * (1.0 - std::cos(angle)), 0.0}};
}

BlindStretch blind(double begin, double end) {
  BlindStretch stretch;
  stretch.begin = kStart + to_ns(begin);
  stretch.end = kStart + to_ns(end);
  stretch.seconds = end - begin;
  return stretch;
}

double bound_of(const Way& way, const AxisChoice& axis, const BlindStretch& stretch, const BoundOptions& options) {
  return posterior_bounds(along(way, seconds_between(kStart, stretch.end) + 5.0), axis, {stretch}, options).front();
}

constexpr AxialNoise kNoise{3.5e-7, 1e-7};

/// Tilt, rotation and gravity known; the bias as well as a steady filter knows it.
BoundOptions known_tilt() {
  BoundOptions options;
  options.noise.accel_psd.setConstant(kNoise.accel_psd);
  options.noise.accel_bias_psd.setConstant(kNoise.accel_bias_psd);
  options.accel_bias_sigma.setConstant(0.02);
  options.gravity_sigma = 1e-9;
  options.rotation_sigma = 1e-7;
  options.step = options.interval;  // exact where rate and specific force are constant
  return options;
}

/// The MTi-600's order of figures.
BoundOptions unknown_tilt() {
  BoundOptions options;
  options.noise.gyro_psd.setConstant(1.5e-8);
  options.noise.gyro_bias_psd.setConstant(2.5e-10);
  options.noise.accel_psd.setConstant(3.5e-7);
  options.noise.accel_bias_psd.setConstant(8e-10);
  options.gyro_bias_sigma.setConstant(3.5e-3);
  options.accel_bias_sigma.setConstant(0.05);
  options.step = options.interval;
  return options;
}

TEST(PosteriorBound, WithKnownTiltOnAStraightLevelRideItIsTheClosedForm) {
  constexpr double kRelative = 2e-3;
  const double closed = portal_to_portal_sigma(kNoise, 0.002, 0.1, 15.0);
  for (const AxisChoice& axis : {kAlongX, kMotion, AxisChoice{AxisKind::kPath, {}}})
    EXPECT_NEAR(bound_of(straight, axis, blind(25, 40), known_tilt()), closed, kRelative * closed);
}

TEST(PosteriorBound, SeenSidewaysABendDoesNotTellHowFarTheBodySlid) {
  constexpr double kRelative = 0.02;
  BoundOptions options = known_tilt();
  options.noise.gyro_psd.z() = 1e-5;  // else a gyro that knows the heading tells the slide by the walls' turn
  const double closed = portal_to_portal_sigma(kNoise, 0.002, 0.1, 15.0);
  EXPECT_NEAR(bound_of(bend, kMotion, blind(25, 40), options), closed, kRelative * closed);
  EXPECT_LT(bound_of(bend, kMotion, blind(25, 40), known_tilt()), 0.5 * closed);
}

TEST(PosteriorBound, AfterAStretchTheMapSaysNothingOfThePositionBefore) {
  constexpr double kRelative = 1e-3;
  const Trajectory truth = along(straight, 100.0);
  const std::vector<double> apart = posterior_bounds(truth, kAlongX, {blind(25, 40), blind(75, 90)}, known_tilt());
  EXPECT_NEAR(apart[1], apart[0], kRelative * apart[0]) << "the bias is known as before";
  const std::vector<double> near = posterior_bounds(truth, kAlongX, {blind(25, 40), blind(40.5, 55.5)}, known_tilt());
  EXPECT_GT(near[1], 1.5 * near[0]) << "half a second has not told the bias again";
}

TEST(PosteriorBound, ATurnPartsBiasAndTiltThatWereKnownOnlyTogether) {
  constexpr double kRelative = 0.01, kAngle = 1.0, kTurn = 2.0, kSeconds = 15.0, kBegin = 10.0, kDt = 1e-3;
  BoundOptions options;  // without noise: what is left are the constants
  options.accel_bias_sigma.setConstant(0.05);
  options.position_sigma = 1e-5;
  const auto angle_at = [&](double t) { return kAngle * std::min(1.0, std::max(0.0, t / kTurn)); };
  const Way turning = [&](double t) {
    return RigidTransform{exp_so3({0.0, 0.0, angle_at(t - kBegin)}), {2.0 * t, 0.0, 0.0}};
  };
  // b - g tilt = 0 at the entry; then the error's acceleration is b - Rot(angle) b. Its position is (a I + c J) b.
  double a = 0.0, c = 0.0;
  for (double t = 0.5 * kDt; t < kSeconds; t += kDt) {
    a += (kSeconds - t) * (1.0 - std::cos(angle_at(t))) * kDt;
    c += (kSeconds - t) * std::sin(angle_at(t)) * kDt;
  }
  const double tilt = kGravityLength * options.gravity_sigma;
  const double bias = 1.0 / std::sqrt(1.0 / (0.05 * 0.05) + 1.0 / (tilt * tilt));
  const double expected = bias * std::hypot(a, c);
  const BlindStretch stretch = blind(kBegin, kBegin + kSeconds);
  EXPECT_NEAR(bound_of(turning, kGround, stretch, options), expected, kRelative * expected);
  EXPECT_LT(bound_of(straight, kGround, stretch, options), 0.01 * expected) << "without a turn they cancel";
}

TEST(PosteriorBound, AGyroThatDriftsOnFlatGroundLosesTheHeadingAndWithItTheWay) {
  constexpr double kRelative = 0.02, kSeconds = 20.0;
  BoundOptions options = known_tilt();
  options.noise.accel_psd.setConstant(1e-12);
  options.noise.accel_bias_psd.setZero();
  options.accel_bias_sigma.setZero();
  options.noise.gyro_psd.setConstant(1.5e-8);
  // Heading a random walk; the velocity is the accelerometer's and keeps its direction in the world, whatever the
  // heading.
  EXPECT_LT(bound_of(straight, kGround, blind(10, 10 + kSeconds), options), 0.01);
  // An acceleration a along the heading puts the heading's error on the velocity across: p'' = a psi.
  const Way speeding = [](double t) {
    return RigidTransform{Eigen::Quaterniond::Identity(), {0.5 * 0.5 * t * t, 0.0, 0.0}};
  };
  const double variance = 1.5e-8 * 0.25 * std::pow(kSeconds, 5) / 20.0;  // of the triple integral of white noise
  const double expected = std::sqrt(variance);
  EXPECT_NEAR(bound_of(speeding, kGround, blind(10, 10 + kSeconds), options), expected, kRelative * expected);
}

TEST(PosteriorBound, ATiltThatDriftsPutsTheSpecificForceOfAClimbOnTheHorizontal) {
  constexpr double kRelative = 0.01, kSeconds = 20.0, kClimb = 2.0, kPsd = 1.5e-8;
  BoundOptions options = known_tilt();
  options.noise.accel_psd.setConstant(1e-12);
  options.noise.accel_bias_psd.setZero();
  options.accel_bias_sigma.setZero();
  options.velocity_sigma = 1e-9;
  options.noise.gyro_psd.setConstant(kPsd);
  options.rotation_sigma = 1.0;
  const Way climbing = [](double t) {
    return RigidTransform{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.5 * kClimb * t * t}};
  };
  const double expected = (kGravityLength + kClimb) * std::sqrt(kPsd * std::pow(kSeconds, 5) / 20.0);
  EXPECT_NEAR(bound_of(climbing, kGround, blind(0, kSeconds), options), expected, kRelative * expected);
}

TEST(PosteriorBound, OnFlatGroundTheHeadingCountsAnewFromEveryStretch) {
  constexpr double kRelative = 0.02;
  BoundOptions options = known_tilt();
  options.noise.accel_psd.setConstant(1e-8);
  options.noise.accel_bias_psd.setConstant(1e-9);
  options.noise.gyro_psd.z() = 1e-6;  // 4 mrad, which over the second stretch would be 0.4 m
  const std::vector<double> bounds =
      posterior_bounds(along(straight, 80.0), kGround, {blind(25, 40), blind(60, 75)}, options);
  EXPECT_NEAR(bounds[1], bounds[0], kRelative * bounds[0]);
  EXPECT_LT(bounds[0], 0.1);
}

TEST(PosteriorBound, MoreSupportNeverMakesItLarger) {
  constexpr double kRounding = 1e-9;
  const auto of = [](const AxisChoice& axis, double begin, double end, const BoundOptions& options) {
    return bound_of(bend, axis, blind(begin, end), options);
  };
  const BoundOptions plain = unknown_tilt();
  for (const AxisChoice& axis : {kMotion, kGround}) {
    const double base = of(axis, 10, 25, plain);
    BoundOptions better = plain;
    better.position_sigma *= 0.5;
    EXPECT_LT(of(axis, 10, 25, better), base + kRounding) << "position";
    better = plain;
    better.rotation_sigma *= 0.5;
    EXPECT_LT(of(axis, 10, 25, better), base + kRounding) << "rotation";
    BoundOptions worse = plain;
    worse.interval *= 2.0;
    EXPECT_GT(of(axis, 10, 25, worse), base - kRounding) << "scans";
    EXPECT_LT(of(axis, 10, 20, plain), base) << "an earlier end";
    EXPECT_LT(of(axis, 15, 25, plain), base) << "a later begin";
  }
  EXPECT_LT(of(kMotion, 10, 25, plain), of(kGround, 10, 25, plain));
}

TEST(PosteriorBound, AStandstillAtTheStartIsKnownAsOneEvenWhereScansAreBlind) {
  const Way starting = [](double t) { return straight(std::max(0.0, t - 5.0)); };
  const double standing = bound_of(starting, kAlongX, blind(0.1, 4.5), unknown_tilt());
  EXPECT_LT(standing, 0.002);
  EXPECT_GT(bound_of(straight, kAlongX, blind(0.1, 4.5), unknown_tilt()), 0.1);
}

TEST(PosteriorBound, ATruthThatEndsOrHasAGapLeavesTheStretchUntold) {
  Trajectory truth = along(straight, 50.0);
  const std::vector<BlindStretch> stretches = {blind(10, 20), blind(30, 40), blind(45, 60)};
  std::vector<double> bounds = posterior_bounds(truth, kAlongX, stretches, unknown_tilt());
  EXPECT_TRUE(std::isfinite(bounds[0]) && std::isfinite(bounds[1]));
  EXPECT_TRUE(std::isnan(bounds[2])) << "the truth ends at 50 s";
  truth.erase(truth.begin() + 50 * 25, truth.begin() + 50 * 26);  // a second long
  bounds = posterior_bounds(truth, kAlongX, stretches, unknown_tilt());
  EXPECT_TRUE(std::isfinite(bounds[0]));
  EXPECT_TRUE(std::isnan(bounds[1])) << "the gap lies before it";
  EXPECT_TRUE(std::isnan(posterior_bounds({}, kAlongX, {blind(1, 2)}, unknown_tilt()).front()));
  EXPECT_TRUE(std::isnan(posterior_bounds(truth, kAlongX, {blind(-5, 5)}, unknown_tilt()).front()));
}

TEST(PosteriorBound, StretchesOutOfOrderAndSigmasThatAreNotPositiveAreRefused) {
  const Trajectory truth = along(straight, 20.0);
  EXPECT_THROW(posterior_bounds(truth, kAlongX, {blind(5, 10), blind(9, 12)}, unknown_tilt()), std::invalid_argument);
  EXPECT_THROW(posterior_bounds(truth, kAlongX, {blind(10, 5)}, unknown_tilt()), std::invalid_argument);
  BoundOptions options = unknown_tilt();
  options.rotation_sigma = 0.0;
  EXPECT_THROW(posterior_bounds(truth, kAlongX, {blind(5, 10)}, options), std::invalid_argument);
}

TEST(PosteriorBound, TheSpecificationsBiasesStartWithTurnOnFigureAndSpread) {
  NoiseSpec spec;
  spec.gyro.turn_on_bias.setConstant(3e-3);
  spec.gyro.bias_sigma.setConstant(4e-3);
  spec.gyro.bias_time.setConstant(100.0);
  spec.accel.turn_on_bias.setConstant(0.05);
  spec.accel.bias_random_walk.setConstant(1e-4);
  const BoundOptions options = bound_options(spec);
  EXPECT_NEAR(options.gyro_bias_sigma.x(), 5e-3, 1e-12);
  EXPECT_NEAR(options.accel_bias_sigma.x(), std::hypot(0.05, bias_spread(spec.accel).x()), 1e-12);
  EXPECT_EQ(options.noise.gyro_bias_rate.x(), 0.0) << "a random walk";
}

TEST(PosteriorBound, TableAndJsonTellItAndForAnAxisTheKnownTiltsFigure) {
  const Trajectory truth = along(straight, 50.0);
  ConsistencySummary summary;
  summary.blind = {blind(20, 35)};
  EXPECT_EQ(consistency_table(summary).find("ideal"), std::string::npos) << "not asked for";
  EXPECT_NE(consistency_json(summary).find("\"bound\": null, \"known_tilt\": null"), std::string::npos);

  add_bounds(truth, kAlongX, known_tilt(), summary);
  EXPECT_EQ(summary.blind[0].bound->ideal, posterior_bounds(truth, kAlongX, summary.blind, known_tilt())[0]);
  EXPECT_EQ(summary.blind[0].bound->known_tilt, portal_to_portal_sigma(kNoise, 0.002, 0.1, 15.0));
  summary.blind[0].bound = StretchBound{0.125, 0.0625};
  EXPECT_NE(consistency_table(summary).find(", what an ideal filter could know 0.125 m (with the tilt known 0.062 m)"),
            std::string::npos)
      << consistency_table(summary);
  EXPECT_NE(consistency_json(summary).find("\"bound\": 0.125, \"known_tilt\": 0.0625"), std::string::npos);

  add_bounds(truth, kGround, known_tilt(), summary);
  EXPECT_EQ(consistency_table(summary).find("tilt known"), std::string::npos) << "there is no axis";
  EXPECT_NE(consistency_json(summary).find("\"known_tilt\": null"), std::string::npos);
  summary.blind = {blind(20, 60)};
  add_bounds(truth, kAlongX, known_tilt(), summary);
  EXPECT_NE(consistency_table(summary).find("not told: the truth has a gap or is too short"), std::string::npos);
  EXPECT_NE(consistency_json(summary).find("\"bound\": null"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
