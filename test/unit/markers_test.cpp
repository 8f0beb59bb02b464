// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/markers.h"

#include <gtest/gtest.h>

#include "allan_lio/math/so3.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/finite.h"

namespace allan_lio {
namespace {

using visualization_msgs::Marker;

constexpr double kExact = 1e-9;

LioResult corridor() {
  LioResult result;
  result.state.nav.stamp = 1600000000 * kNsPerSecond;
  result.state.nav.T_world_imu = {exp_so3({0, 0, 1.0}), {1.0, 2.0, 3.0}};
  result.covariance.block<3, 3>(kPosition, kPosition).diagonal() << 0.04, 0.01, 0.0001;
  result.localizability.support << 0.1, 0.2, 1, 1, 1, 1;
  result.localizability.directions.setIdentity();
  result.localizability.directions.col(0) << 0, 0, 0, 0.6, 0.8, 0;  // along the corridor
  result.localizability.directions.col(1) << 1, 0, 0, 0, 0.1, 0;    // roll
  return result;
}

TEST(Markers, the_ellipsoid_has_the_half_axes_of_three_sigma) {
  const auto array = to_markers(corridor(), "odom");
  const Marker& marker = array->markers.front();
  EXPECT_EQ(marker.type, Marker::SPHERE);
  EXPECT_EQ(marker.header.frame_id, "odom");
  EXPECT_NEAR(marker.pose.position.z, 3.0, kExact);
  // An ellipsoid's points are R S u, so its matrix is R S^2 R^T: (2 * 3)^2 times the covariance for diameters.
  const Eigen::Matrix3d axes = from_quaternion(marker.pose.orientation).toRotationMatrix();
  const Eigen::Vector3d squares = from_vector(marker.scale).cwiseAbs2();
  const Eigen::Matrix3d shape = axes * squares.asDiagonal() * axes.transpose();
  EXPECT_LT((shape / 36.0 - corridor().covariance.block<3, 3>(kPosition, kPosition)).norm(), kExact);
}

TEST(Markers, a_weak_axis_is_a_bar_along_it_and_a_supported_one_is_deleted) {
  const auto array = to_markers(corridor(), "odom");
  ASSERT_EQ(array->markers.size(), 7U);
  const Marker &along = array->markers[1], &roll = array->markers[2];
  ASSERT_EQ(along.points.size(), 2U);
  Eigen::Vector3d bar = from_point(along.points[1]) - from_point(along.points[0]);
  EXPECT_LT((bar.normalized() - Eigen::Vector3d(0.6, 0.8, 0)).norm(), kExact);
  // Rotations are about the IMU's axes.
  bar = from_point(roll.points[1]) - from_point(roll.points[0]);
  EXPECT_LT((bar.normalized() - exp_so3({0, 0, 1.0}) * Eigen::Vector3d::UnitX()).norm(), kExact);
  EXPECT_NE(along.color.g, roll.color.g);
  for (int k = 3; k < 7; ++k) EXPECT_EQ(array->markers[k].action, Marker::DELETE);
}

TEST(Markers, an_estimate_without_uncertainty_makes_finite_markers_too) {
  LioResult result = corridor();
  result.covariance.setZero();
  result.localizability.directions.setZero();
  EXPECT_TRUE(all_finite(*to_markers(result, "odom")));
}

}  // namespace
}  // namespace allan_lio
