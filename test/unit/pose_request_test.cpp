// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/pose_request.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>

#include "allan_lio/math/so3.h"
#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

constexpr int kSamples = 100000;
constexpr double kMonteCarloTolerance = 0.02;  // of the matrix's norm
constexpr double kExact = 1e-12;

const RigidTransform kBaseImu{exp_so3({0.1, -0.2, 1.3}), {0.6, -0.4, 1.1}};
const Eigen::Quaterniond kTilted{exp_so3({0.05, -0.1, 0.7})};

geometry_msgs::PoseWithCovarianceStamped request(double heading) {
  geometry_msgs::PoseWithCovarianceStamped message;
  message.header.frame_id = "odom";
  message.pose.pose.position = to_point({10.0, -5.0, 2.0});
  message.pose.pose.orientation = to_quaternion(exp_so3({0, 0, heading}));
  Matrix6 root = Matrix6::Zero();
  root.diagonal() << 0.1, 0.2, 0.05, 0.01, 0.02, 0.06;
  root(0, 1) = 0.05;
  root(1, 5) = 0.03;
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.pose.covariance.data()) = root * root.transpose();
  return message;
}

RigidTransform base_of(const PoseAnchor& anchor) { return anchor.T_world_imu * kBaseImu.inverse(); }

double heading_of(const Eigen::Quaterniond& q) {
  const Eigen::Vector3d x = q * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

std::string refusal(const geometry_msgs::PoseWithCovarianceStamped& message) {
  try {
    to_anchor(message, "odom", kBaseImu, std::nullopt);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PoseRequest, the_base_gets_position_and_heading_and_keeps_the_filters_tilt) {
  const PoseAnchor anchor = to_anchor(request(2.5), "odom", kBaseImu, kTilted);
  EXPECT_LT((base_of(anchor).translation - Eigen::Vector3d(10.0, -5.0, 2.0)).norm(), kExact);
  EXPECT_NEAR(heading_of(base_of(anchor).rotation), 2.5, kExact);
  const Eigen::Vector3d up_before = kTilted.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d up_after = anchor.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up_before - up_after).norm(), kExact);
}

TEST(PoseRequest, before_the_first_estimate_the_pose_is_taken_as_it_is) {
  const PoseAnchor anchor = to_anchor(request(-1.0), "odom", kBaseImu, std::nullopt);
  EXPECT_LT((base_of(anchor).rotation.coeffs() - exp_so3({0, 0, -1.0}).coeffs()).norm(), kExact);
}

TEST(PoseRequest, the_imus_covariance_equals_monte_carlo_over_the_lever_arm) {
  const geometry_msgs::PoseWithCovarianceStamped message = request(0.4);
  const PoseAnchor anchor = to_anchor(message, "odom", kBaseImu, kTilted);
  Matrix6 covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.pose.covariance.data());
  const Matrix6 root = covariance.llt().matrixL();
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (int i = 0; i < kSamples; ++i) {
    Vector6 unit;
    for (int k = 0; k < 6; ++k) unit[k] = normal(random);
    const Vector6 error = root * unit;
    const Eigen::Quaterniond turn = exp_so3({0, 0, error[5]});
    const RigidTransform truth{turn * base_of(anchor).rotation, base_of(anchor).translation + error.head<3>()};
    const Eigen::Vector3d d = (truth * kBaseImu).translation - anchor.T_world_imu.translation;
    sum += d * d.transpose();
  }
  EXPECT_LT((sum / kSamples - anchor.position_covariance).norm(),
            kMonteCarloTolerance * anchor.position_covariance.norm())
      << sum / kSamples << "\n\n"
      << anchor.position_covariance;
  EXPECT_NEAR(anchor.heading_variance, covariance(5, 5), kExact);
}

TEST(PoseRequest, what_makes_no_sense_is_refused_with_a_sentence) {
  EXPECT_EQ(refusal(request(0)), "");
  auto message = request(0);
  message.header.frame_id = "map";
  EXPECT_NE(refusal(message).find("'map'"), std::string::npos);
  message = request(0);
  message.pose.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(message).find("finite"), std::string::npos);
  message = request(0);
  message.pose.pose.orientation = geometry_msgs::Quaternion();
  EXPECT_NE(refusal(message).find("length"), std::string::npos);
  message = request(0);
  message.pose.covariance[0] = -1.0;
  EXPECT_NE(refusal(message).find("covariance"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
