// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/weak_axis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

const double kQuarterTurn = std::acos(0.0);
constexpr double kExact = 1e-12;

/// Along (0.6, 0.8, 0) nothing is seen, and hardly anything of the turn about the IMU's x axis, which is the world's y.
LioResult corridor() {
  LioResult result;
  result.state.nav.T_world_imu.rotation = exp_so3({0, 0, kQuarterTurn});
  result.localizability.support << 0.1, 0.2, 0.5, 1, 1, 1;
  result.localizability.directions.col(0) << 0, 0, 0, -0.6, -0.8, 0;
  result.localizability.directions.col(1) << 0.995, 0, 0, 0, 0, 0.0999;
  return result;
}

TEST(WeakAxis, ATranslationIsAlongTheWorldsAxesAndARotationIsTurnedToThem) {
  const auto along = weak_axis(corridor(), 0), roll = weak_axis(corridor(), 1);
  ASSERT_TRUE(along && roll);
  EXPECT_FALSE(along->turns);
  EXPECT_LT(along->axis.cross(Eigen::Vector3d(0.6, 0.8, 0)).norm(), kExact);
  EXPECT_TRUE(roll->turns);
  EXPECT_LT(roll->axis.cross(Eigen::Vector3d::UnitY()).norm(), kExact);
  EXPECT_NEAR(along->axis.norm(), 1.0, kExact);
  EXPECT_NEAR(roll->axis.norm(), 1.0, kExact);
}

TEST(WeakAxis, HalfOfTheWeightIsEnough) {
  EXPECT_FALSE(weak_axis(corridor(), 2));
  LioResult nothing = corridor();
  nothing.localizability.directions.setZero();
  EXPECT_FALSE(weak_axis(nothing, 0)) << "no direction";
}

TEST(WeakAxis, AllAreNamedTheWeakestFirstAndWithOneSign) {
  EXPECT_EQ(name_weak_axes(corridor()), "translation along (0.60 0.80 0.00); rotation about (0.00 1.00 0.00)");
  LioResult other = corridor();
  other.localizability.directions.col(0) *= -1.0;
  EXPECT_EQ(name_weak_axes(other), "translation along (0.60 0.80 0.00); rotation about (0.00 1.00 0.00)");
}

TEST(WeakAxis, WhereThereIsNoneItIsSaid) {
  LioResult result = corridor();
  result.localizability.support.setOnes();
  EXPECT_EQ(name_weak_axes(result), "none");
  result.outcome = ScanOutcome::kTooFewMatches;
  EXPECT_EQ(name_weak_axes(result), "the scan was not registered");
}

}  // namespace
}  // namespace allan_lio
