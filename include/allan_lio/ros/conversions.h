// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <nav_msgs/Odometry.h>
#include <ros/time.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/imu/nav_state.h"
#include "allan_lio/lio/odometry.h"
#include "allan_lio/math/rigid_transform.h"

namespace allan_lio {

TimeNs to_time_ns(const ros::Time& time);

/// ROS has no time before 1970 and none after 2106: the nearest that it has.
ros::Time to_ros_time(TimeNs time);

/// [s]. ROS's own difference of times throws where it is more than 68 years, as a damaged bag or a clock gone wild has
/// it.
double seconds_between(const ros::Time& from, const ros::Time& to);

/// Readings as they are: g or m/s^2 is the filter's question.
ImuSample to_imu_sample(const sensor_msgs::Imu& message);

geometry_msgs::Point to_point(const Eigen::Vector3d& p);
geometry_msgs::Vector3 to_vector(const Eigen::Vector3d& v);
geometry_msgs::Quaternion to_quaternion(const Eigen::Quaterniond& q);
geometry_msgs::Pose to_pose(const RigidTransform& T);
geometry_msgs::Transform to_transform(const RigidTransform& T);
Eigen::Vector3d from_point(const geometry_msgs::Point& p);
Eigen::Vector3d from_vector(const geometry_msgs::Vector3& v);
Eigen::Quaterniond from_quaternion(const geometry_msgs::Quaternion& q);
RigidTransform from_transform(const geometry_msgs::Transform& T);

/// An inertial estimate, and what it takes to speak of the base instead of the IMU.
struct BaseEstimate {
  NavState state;
  NavMatrix covariance = NavMatrix::Zero();
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();           ///< bias taken off [rad/s], IMU frame
  Eigen::Vector3d gyro_variance = Eigen::Vector3d::Zero();  ///< of the reading's white noise [(rad/s)^2], IMU frame
  RigidTransform T_base_imu;
};

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

RigidTransform base_pose(const BaseEstimate& estimate);

/// Covariance of base_pose() as geometry_msgs/PoseWithCovariance wants it: position [m], then rotation about the
/// fixed axes of the world [rad]. With R = R_est Exp(dtheta) the rotation about fixed axes is R_est dtheta.
Matrix6 base_pose_covariance(const BaseEstimate& estimate);

/// Linear [m/s], then angular velocity [rad/s] of the base, in the base frame.
Vector6 base_twist(const BaseEstimate& estimate);
Matrix6 base_twist_covariance(const BaseEstimate& estimate);

/// Pose of the base in `odom_frame`, twist in the base frame, both with covariances (row-major).
nav_msgs::OdometryPtr to_odometry(const BaseEstimate& estimate, const std::string& odom_frame,
                                  const std::string& base_frame);

/// x, y, z, intensity as float32; points that are not finite are left out.
sensor_msgs::PointCloud2Ptr to_cloud(const std::vector<WorldPoint>& points, const std::string& frame, TimeNs stamp);

}  // namespace allan_lio
