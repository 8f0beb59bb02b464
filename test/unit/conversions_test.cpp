// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/conversions.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr int kSamples = 200000;
constexpr double kMonteCarloTolerance = 0.02;  // of the matrix's norm; sampling alone makes about 0.005
constexpr double kExact = 1e-12;

/// Far from every symmetry: turned, moving fast, with a lever arm and a turned base.
BaseEstimate tilted_estimate() {
  BaseEstimate estimate;
  estimate.state.stamp = 1600000000'123456789;
  estimate.state.T_world_imu = {exp_so3({0.4, -0.7, 1.9}), {10.0, -3.0, 2.0}};
  estimate.state.velocity_world = {4.0, -2.0, 1.0};
  estimate.gyro = {0.3, -0.8, 0.5};
  estimate.gyro_variance = {4e-6, 9e-6, 1e-6};
  estimate.T_base_imu = {exp_so3({-0.3, 0.2, 0.9}), {0.6, -0.4, 1.1}};
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  NavMatrix root;
  for (int i = 0; i < root.size(); ++i) root.data()[i] = 1e-3 * normal(random);
  estimate.covariance = root * root.transpose();
  return estimate;
}

/// Sample covariance of what `deviation` gives for errors drawn from the estimate's covariance.
template <class Deviation>
Matrix6 sample_covariance(const BaseEstimate& estimate, Deviation deviation) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  const NavMatrix root = estimate.covariance.llt().matrixL();
  Matrix6 sum = Matrix6::Zero();
  for (int i = 0; i < kSamples; ++i) {
    NavVector unit;
    for (int k = 0; k < kNavDof; ++k) unit[k] = normal(random);
    const NavVector error = root * unit;
    BaseEstimate truth = estimate;
    truth.state = nav_plus(estimate.state, error);
    // reading = rate + bias + white noise, hence rate = (reading - bias_est) - (bias error) - (white noise)
    for (int k = 0; k < 3; ++k)
      truth.gyro[k] -= error[kGyroBias + k] + std::sqrt(estimate.gyro_variance[k]) * normal(random);
    const Vector6 d = deviation(truth);
    sum += d * d.transpose();
  }
  return sum / kSamples;
}

TEST(Conversions, pose_covariance_equals_monte_carlo_about_fixed_axes) {
  const BaseEstimate estimate = tilted_estimate();
  const RigidTransform pose = base_pose(estimate);
  const Matrix6 sampled = sample_covariance(estimate, [&](const BaseEstimate& truth) {
    const RigidTransform other = base_pose(truth);
    Vector6 d;
    d << other.translation - pose.translation, log_so3(other.rotation * pose.rotation.conjugate());
    return d;
  });
  const Matrix6 claimed = base_pose_covariance(estimate);
  EXPECT_LT((sampled - claimed).norm(), kMonteCarloTolerance * claimed.norm()) << sampled << "\n\n" << claimed;
}

TEST(Conversions, twist_covariance_equals_monte_carlo_in_the_base_frame) {
  const BaseEstimate estimate = tilted_estimate();
  const Vector6 twist = base_twist(estimate);
  const Matrix6 sampled =
      sample_covariance(estimate, [&](const BaseEstimate& truth) -> Vector6 { return base_twist(truth) - twist; });
  const Matrix6 claimed = base_twist_covariance(estimate);
  EXPECT_LT((sampled - claimed).norm(), kMonteCarloTolerance * claimed.norm()) << sampled << "\n\n" << claimed;
  const Eigen::Matrix3d sampled_rate = sampled.bottomRightCorner<3, 3>();
  const Eigen::Matrix3d claimed_rate = claimed.bottomRightCorner<3, 3>();
  EXPECT_LT((sampled_rate - claimed_rate).norm(), kMonteCarloTolerance * claimed_rate.norm());
}

TEST(Conversions, twist_is_the_derivative_of_the_base_pose) {
  const BaseEstimate now = tilted_estimate();
  constexpr double kStep = 1e-6;
  BaseEstimate later = now;
  later.state.T_world_imu.rotation = now.state.T_world_imu.rotation * exp_so3(kStep * now.gyro);
  later.state.T_world_imu.translation += kStep * now.state.velocity_world;
  const RigidTransform motion = base_pose(now).inverse() * base_pose(later);
  EXPECT_LT((motion.translation / kStep - base_twist(now).head<3>()).norm(), 1e-5);
  EXPECT_LT((log_so3(motion.rotation) / kStep - base_twist(now).tail<3>()).norm(), 1e-5);
}

TEST(Conversions, a_base_that_is_the_imu_changes_nothing) {
  BaseEstimate estimate = tilted_estimate();
  estimate.T_base_imu = RigidTransform();
  EXPECT_LT((base_pose(estimate).translation - estimate.state.T_world_imu.translation).norm(), kExact);
  EXPECT_LT((base_twist(estimate).tail<3>() - estimate.gyro).norm(), kExact);
  const Matrix6 pose = base_pose_covariance(estimate);
  const Eigen::Matrix3d position = estimate.covariance.block<3, 3>(kPosition, kPosition);
  EXPECT_LT((pose.topLeftCorner<3, 3>() - position).norm(), kExact);
}

TEST(Conversions, odometry_message_holds_both_covariances_row_by_row) {
  const BaseEstimate estimate = tilted_estimate();
  const nav_msgs::OdometryPtr message = to_odometry(estimate, "odom", "base_link");
  EXPECT_EQ(message->header.frame_id, "odom");
  EXPECT_EQ(message->child_frame_id, "base_link");
  EXPECT_EQ(to_time_ns(message->header.stamp), estimate.state.stamp);
  EXPECT_NEAR(message->pose.covariance[5], base_pose_covariance(estimate)(0, 5), kExact);
  EXPECT_NEAR(message->twist.covariance[3 * 6 + 1], base_twist_covariance(estimate)(3, 1), kExact);
}

TEST(Conversions, times_go_there_and_back_and_stay_inside_what_ros_holds) {
  EXPECT_EQ(to_time_ns(to_ros_time(1600000000'123456789)), 1600000000'123456789);
  EXPECT_EQ(to_ros_time(-5), ros::Time(0, 0));
  EXPECT_EQ(to_ros_time(std::numeric_limits<TimeNs>::max()), ros::Time(0xFFFFFFFF, 999999999));
}

TEST(Conversions, clouds_leave_out_what_is_not_finite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const sensor_msgs::PointCloud2Ptr cloud = to_cloud({{1, 2, 3, 4}, {nan, 0, 0, 0}, {5, 6, 7, 8}}, "odom", 1);
  EXPECT_EQ(cloud->width * cloud->height, 2U);
  EXPECT_EQ(cloud->data.size(), 2U * sizeof(WorldPoint));
  float x = 0;
  std::memcpy(&x, &cloud->data[cloud->point_step + cloud->fields[0].offset], sizeof x);
  EXPECT_EQ(x, 5.0F);
}

}  // namespace
}  // namespace allan_lio
