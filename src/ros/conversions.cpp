// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/conversions.h"

#include <sensor_msgs/point_cloud2_iterator.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

Eigen::Matrix3d R_base_imu(const BaseEstimate& estimate) { return estimate.T_base_imu.rotation.toRotationMatrix(); }

/// The base's origin in the IMU frame [m].
Eigen::Vector3d lever_arm(const BaseEstimate& estimate) { return estimate.T_base_imu.inverse().translation; }

template <class Array>
void store(const Matrix6& matrix, Array& row_major) {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(row_major.data()) = 0.5 * (matrix + matrix.transpose());
}

}  // namespace

TimeNs to_time_ns(const ros::Time& time) { return TimeNs{time.sec} * kNsPerSecond + TimeNs{time.nsec}; }

ros::Time to_ros_time(TimeNs time) {
  constexpr TimeNs kLatest = (TimeNs{std::numeric_limits<std::uint32_t>::max()} + 1) * kNsPerSecond - 1;
  const TimeNs held = std::clamp<TimeNs>(time, 0, kLatest);
  return {static_cast<std::uint32_t>(held / kNsPerSecond), static_cast<std::uint32_t>(held % kNsPerSecond)};
}

double seconds_between(const ros::Time& from, const ros::Time& to) {
  return seconds_between(to_time_ns(from), to_time_ns(to));
}

ImuSample to_imu_sample(const sensor_msgs::Imu& message) {
  return {to_time_ns(message.header.stamp), from_vector(message.angular_velocity),
          from_vector(message.linear_acceleration)};
}

geometry_msgs::Point to_point(const Eigen::Vector3d& p) {
  geometry_msgs::Point message;
  message.x = p.x();
  message.y = p.y();
  message.z = p.z();
  return message;
}

geometry_msgs::Vector3 to_vector(const Eigen::Vector3d& v) {
  geometry_msgs::Vector3 message;
  message.x = v.x();
  message.y = v.y();
  message.z = v.z();
  return message;
}

geometry_msgs::Quaternion to_quaternion(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  message.w = q.w();
  return message;
}

geometry_msgs::Pose to_pose(const RigidTransform& T) {
  geometry_msgs::Pose message;
  message.position = to_point(T.translation);
  message.orientation = to_quaternion(T.rotation);
  return message;
}

geometry_msgs::Transform to_transform(const RigidTransform& T) {
  geometry_msgs::Transform message;
  message.translation = to_vector(T.translation);
  message.rotation = to_quaternion(T.rotation);
  return message;
}

Eigen::Vector3d from_point(const geometry_msgs::Point& p) { return {p.x, p.y, p.z}; }
Eigen::Vector3d from_vector(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }
Eigen::Quaterniond from_quaternion(const geometry_msgs::Quaternion& q) { return {q.w, q.x, q.y, q.z}; }
RigidTransform from_transform(const geometry_msgs::Transform& T) {
  return {from_quaternion(T.rotation).normalized(), from_vector(T.translation)};
}

RigidTransform base_pose(const BaseEstimate& estimate) {
  return estimate.state.T_world_imu * estimate.T_base_imu.inverse();
}

Matrix6 base_pose_covariance(const BaseEstimate& estimate) {
  const Eigen::Matrix3d rotation = estimate.state.T_world_imu.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, kNavDof> jacobian = Eigen::Matrix<double, 6, kNavDof>::Zero();
  jacobian.block<3, 3>(0, kPosition).setIdentity();
  jacobian.block<3, 3>(0, kTheta) = -rotation * skew(lever_arm(estimate));
  jacobian.block<3, 3>(3, kTheta) = rotation;
  return jacobian * estimate.covariance * jacobian.transpose();
}

Vector6 base_twist(const BaseEstimate& estimate) {
  const Eigen::Vector3d velocity_imu = estimate.state.T_world_imu.rotation.conjugate() * estimate.state.velocity_world;
  Vector6 twist;
  twist.head<3>() = R_base_imu(estimate) * (velocity_imu + estimate.gyro.cross(lever_arm(estimate)));
  twist.tail<3>() = R_base_imu(estimate) * estimate.gyro;
  return twist;
}

Matrix6 base_twist_covariance(const BaseEstimate& estimate) {
  const Eigen::Matrix3d world_to_imu = estimate.state.T_world_imu.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d turn = R_base_imu(estimate);
  // The rate's error is -(gyro bias error) - (white noise); it reaches the linear velocity over the lever arm.
  Eigen::Matrix<double, 6, 3> by_rate;
  by_rate << -turn * skew(lever_arm(estimate)), turn;

  Eigen::Matrix<double, 6, kNavDof> jacobian = Eigen::Matrix<double, 6, kNavDof>::Zero();
  jacobian.block<3, 3>(0, kTheta) = turn * skew(world_to_imu * estimate.state.velocity_world);
  jacobian.block<3, 3>(0, kVelocity) = turn * world_to_imu;
  jacobian.middleCols<3>(kGyroBias) = -by_rate;
  return jacobian * estimate.covariance * jacobian.transpose() +
         by_rate * estimate.gyro_variance.asDiagonal() * by_rate.transpose();
}

nav_msgs::OdometryPtr to_odometry(const BaseEstimate& estimate, const std::string& odom_frame,
                                  const std::string& base_frame) {
  auto message = boost::make_shared<nav_msgs::Odometry>();
  message->header.stamp = to_ros_time(estimate.state.stamp);
  message->header.frame_id = odom_frame;
  message->child_frame_id = base_frame;
  message->pose.pose = to_pose(base_pose(estimate));
  store(base_pose_covariance(estimate), message->pose.covariance);
  const Vector6 twist = base_twist(estimate);
  message->twist.twist.linear = to_vector(twist.head<3>());
  message->twist.twist.angular = to_vector(twist.tail<3>());
  store(base_twist_covariance(estimate), message->twist.covariance);
  return message;
}

sensor_msgs::PointCloud2Ptr to_cloud(const std::vector<WorldPoint>& points, const std::string& frame, TimeNs stamp) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header.stamp = to_ros_time(stamp);
  cloud->header.frame_id = frame;
  sensor_msgs::PointCloud2Modifier modifier(*cloud);
  modifier.setPointCloud2Fields(4, "x", 1, sensor_msgs::PointField::FLOAT32, "y", 1, sensor_msgs::PointField::FLOAT32,
                                "z", 1, sensor_msgs::PointField::FLOAT32, "intensity", 1,
                                sensor_msgs::PointField::FLOAT32);
  static_assert(sizeof(WorldPoint) == 4 * sizeof(float), "a WorldPoint is copied as it lies in memory");
  cloud->data.resize(points.size() * sizeof(WorldPoint));
  std::size_t kept = 0;
  for (const WorldPoint& p : points) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z) || !std::isfinite(p.intensity)) continue;
    std::memcpy(cloud->data.data() + kept * sizeof p, &p, sizeof p);
    ++kept;
  }
  modifier.resize(kept);
  cloud->is_dense = true;
  return cloud;
}

}  // namespace allan_lio
