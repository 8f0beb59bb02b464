// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/pose_request.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <stdexcept>

#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/finite.h"

namespace allan_lio {
namespace {

constexpr double kUnitTolerance = 1e-2;  // of the quaternion's length

double heading_of(const Eigen::Quaterniond& R_world_base) {
  const Eigen::Vector3d x = R_world_base * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

Matrix6 checked_covariance(const geometry_msgs::PoseWithCovariance& pose) {
  const Matrix6 given = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance.data());
  const Matrix6 covariance = 0.5 * (given + given.transpose());
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(covariance, Eigen::EigenvaluesOnly);
  const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
  if (solver.eigenvalues().minCoeff() < -1e-6 * largest || (given - given.transpose()).norm() > 1e-6 * given.norm())
    throw std::runtime_error("pose.covariance is not symmetric and positive semidefinite");
  return covariance;
}

}  // namespace

PoseAnchor to_anchor(const geometry_msgs::PoseWithCovarianceStamped& request, const std::string& odom_frame,
                     const RigidTransform& T_base_imu, const std::optional<Eigen::Quaterniond>& R_world_imu) {
  const std::string& frame = request.header.frame_id;
  if (!frame.empty() && frame != odom_frame)
    throw std::runtime_error("pose.header.frame_id is '" + frame + "', must be '" + odom_frame + "' or empty");
  if (!all_finite(request)) throw std::runtime_error("the pose or its covariance is not finite");
  const Eigen::Quaterniond requested = from_quaternion(request.pose.pose.orientation);
  if (std::abs(requested.norm() - 1.0) > kUnitTolerance)
    throw std::runtime_error("pose.orientation is a quaternion of length " + std::to_string(requested.norm()));

  const Eigen::Quaterniond R_base_imu = T_base_imu.rotation;
  const Eigen::Quaterniond R_world_base = R_world_imu ? *R_world_imu * R_base_imu.conjugate() : requested.normalized();
  const double turn = heading_of(requested.normalized()) - heading_of(R_world_base);
  PoseAnchor anchor;
  const RigidTransform T_world_base{
      Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())) * R_world_base,
      from_point(request.pose.pose.position)};
  anchor.T_world_imu = T_world_base * T_base_imu;
  // The IMU sits on a lever arm that turns with the heading.
  const Eigen::Vector3d arm = T_world_base.rotation * T_base_imu.translation;
  Eigen::Matrix<double, 3, 6> jacobian = Eigen::Matrix<double, 3, 6>::Identity();
  jacobian.col(5) = Eigen::Vector3d::UnitZ().cross(arm);
  const Matrix6 covariance = checked_covariance(request.pose);
  anchor.position_covariance = jacobian * covariance * jacobian.transpose();
  anchor.heading_variance = covariance(5, 5);
  return anchor;
}

}  // namespace allan_lio
