// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/finite.h"

#include <allan_lio/State.h>
#include <allan_lio/Status.h>
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>
#include <visualization_msgs/MarkerArray.h>

#include <functional>
#include <limits>

namespace allan_lio {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A message is finite, and no more when the field is not.
template <class Message>
void expect_found(Message message, const std::function<double&(Message&)>& field) {
  EXPECT_TRUE(all_finite(message));
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    Message spoilt = message;
    field(spoilt) = bad;
    EXPECT_FALSE(all_finite(spoilt));
  }
}

TEST(Finite, a_number_that_is_not_is_found_in_every_corner_of_what_the_filter_publishes) {
  using nav_msgs::Odometry;
  expect_found<Odometry>({}, [](Odometry& m) -> double& { return m.pose.pose.position.y; });
  expect_found<Odometry>({}, [](Odometry& m) -> double& { return m.pose.pose.orientation.w; });
  expect_found<Odometry>({}, [](Odometry& m) -> double& { return m.pose.covariance[35]; });
  expect_found<Odometry>({}, [](Odometry& m) -> double& { return m.twist.twist.angular.z; });
  expect_found<Odometry>({}, [](Odometry& m) -> double& { return m.twist.covariance[0]; });
  expect_found<State>({}, [](State& m) -> double& { return m.covariance[528]; });
  expect_found<State>({}, [](State& m) -> double& { return m.probability[5]; });
  expect_found<State>({}, [](State& m) -> double& { return m.k_r; });
  expect_found<Status>({}, [](Status& m) -> double& { return m.nis_mean; });
  expect_found<Status>({}, [](Status& m) -> double& { return m.accel_bias_sigma.z; });
  expect_found<geometry_msgs::TransformStamped>(
      {}, [](geometry_msgs::TransformStamped& m) -> double& { return m.transform.rotation.x; });
}

TEST(Finite, lists_of_messages_are_looked_through_to_the_last) {
  nav_msgs::Path path;
  path.poses.resize(3);
  expect_found<nav_msgs::Path>(path, [](nav_msgs::Path& m) -> double& { return m.poses[2].pose.position.x; });
  visualization_msgs::MarkerArray array;
  array.markers.resize(2);
  array.markers[1].points.resize(2);
  expect_found<visualization_msgs::MarkerArray>(
      array, [](visualization_msgs::MarkerArray& m) -> double& { return m.markers[1].points[1].z; });
  array.markers[0].color.a = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(all_finite(array));
}

}  // namespace
}  // namespace allan_lio
