// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/nav_state.h"

#include <gtest/gtest.h>

#include <vector>

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"
#include "central_differences.h"

namespace allan_lio {
namespace {

constexpr double kRounding = 1e-13;  // of entries up to 10
constexpr double kStep = 1e-3;
constexpr double kDifference = 1e-9;

const std::vector<StateBlock> kBlocks = {{"theta", kTheta, 3},          {"position", kPosition, 3},
                                         {"velocity", kVelocity, 3},    {"gyro bias", kGyroBias, 3},
                                         {"accel bias", kAccelBias, 3}, {"gravity", kGravity, 2}};

NavState some_state() {
  NavState x;
  x.stamp = 1'600'000'000'123'456'789;
  x.T_world_imu = {exp_so3({0.4, -1.1, 2.0}), {10, -3, 2}};
  x.velocity_world << 1, 2, -0.5;
  x.gyro_bias << 0.01, -0.02, 0.003;
  x.accel_bias << -0.1, 0.05, 0.2;
  x.gravity_world = 9.8 * Eigen::Vector3d(0.02, -0.01, -1.0).normalized();
  return x;
}

NavVector some_step(double angle) {
  NavVector d;
  d << 0.48, -0.6, 0.64, 1, 2, 3, -4, 5, 6, 0.1, 0.2, -0.3, 0.4, -0.5, 0.6, 0.6, 0.8;
  d.segment<3>(kTheta) *= angle;
  d.segment<2>(kGravity) *= angle;
  return d;
}

TEST(NavState, TheErrorStateHoldsEveryBlockOnce) {
  int end = 0;
  for (const StateBlock& block : kBlocks) {
    EXPECT_EQ(block.begin, end) << block.name;
    end += block.size;
  }
  EXPECT_EQ(end, static_cast<int>(kNavDof));
}

TEST(NavState, MinusUndoesPlus) {
  for (const double angle : {0.0, 1e-9, 1e-5, 0.3, 1.0, 2.0}) {
    const NavVector d = some_step(angle);
    const NavVector back = nav_minus(nav_plus(some_state(), d), some_state());
    for (const StateBlock& block : kBlocks)
      EXPECT_LT((back - d).segment(block.begin, block.size).norm(), kRounding) << block.name << ", angle " << angle;
  }
}

TEST(NavState, PlusUndoesMinus) {
  const NavState x = some_state(), y = nav_plus(x, some_step(0.7));
  const NavState back = nav_plus(x, nav_minus(y, x));
  EXPECT_LT(nav_minus(back, y).norm(), kRounding);
}

TEST(NavState, PlusPerturbsTheRotationOnTheRightAndKeepsStampAndGravity) {
  NavVector d = NavVector::Zero();
  d.segment<3>(kTheta) << 0.1, 0.2, -0.3;
  d.segment<2>(kGravity) << 0.01, 0.02;
  const NavState x = some_state(), y = nav_plus(x, d);
  const Eigen::Matrix3d expected =
      x.T_world_imu.rotation.toRotationMatrix() * exp_so3({0.1, 0.2, -0.3}).toRotationMatrix();
  EXPECT_LT((y.T_world_imu.rotation.toRotationMatrix() - expected).norm(), kRounding);
  EXPECT_EQ(y.stamp, x.stamp);
  EXPECT_NEAR(y.gravity_world.norm(), x.gravity_world.norm(), kRounding);
}

TEST(NavState, MinusJacobianAgreesWithCentralDifferences) {
  const NavState x = some_state();
  for (const double angle : {0.0, 1e-9, 1e-5, 0.3, 1.0, 2.0}) {
    const NavState y = nav_plus(x, some_step(angle));
    const Eigen::MatrixXd numeric = central_differences(
        [&](const Eigen::VectorXd& d) { return nav_minus(nav_plus(y, NavVector(d)), x); }, kNavDof, kStep);
    EXPECT_EQ(differing_blocks(nav_minus_jacobian(y, x), numeric, kBlocks, kDifference), "") << "angle " << angle;
  }
}

}  // namespace
}  // namespace allan_lio
