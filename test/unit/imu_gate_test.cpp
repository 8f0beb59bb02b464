// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_gate.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kUnits[] = {1.0, kGravity};  // [m/s^2] of a reading of 1
constexpr TimeNs kStep = 5'000'000;           // [ns]

/// A reading of so many g by a sensor of that unit.
ImuSample reading(double g, double unit, TimeNs stamp = 0) {
  return {stamp, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, -g * kGravity / unit)};
}

TEST(ImuGate, FiftyGAreTheLimitInEitherUnit) {
  for (const double unit : kUnits) {
    ImuGate gate;
    gate.set_accel_scale(unit);
    EXPECT_TRUE(gate.pass(reading(49, unit)).sample) << unit;
    const ImuGate::Passed passed = gate.pass(reading(51, unit, kStep));
    EXPECT_TRUE(passed.absurd) << unit;
    EXPECT_FALSE(passed.sample) << unit;
  }
}

TEST(ImuGate, BeforeTheUnitIsKnownNothingIsDroppedThatIsRightInEither) {
  ImuGate gate;
  for (const double unit : kUnits) EXPECT_TRUE(gate.pass(reading(49, unit)).sample) << unit;
  EXPECT_TRUE(gate.pass(reading(51, 1.0)).absurd);
}

TEST(ImuGate, ASampleThatIsKeptBackIsJudgedByTheUnitThatIsLearntMeanwhile) {
  for (const bool absurd : {true, false}) {
    ImuGate gate;
    gate.pass(reading(1, kGravity));
    ASSERT_FALSE(gate.pass(reading(absurd ? 51 : 49, kGravity, 2 * kNsPerSecond)).sample);
    EXPECT_EQ(gate.set_accel_scale(kGravity), absurd);
    EXPECT_EQ(gate.release().has_value(), !absurd);
  }
}

}  // namespace
}  // namespace allan_lio
