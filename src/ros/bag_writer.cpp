// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_writer.h"

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <cstring>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

using sensor_msgs::PointField;

// Velodyne's XYZIRT layout, packed.
constexpr std::uint32_t kOffsetX = 0, kOffsetIntensity = 12, kOffsetRing = 16, kOffsetTime = 18, kPointStep = 22;

PointField make_field(const std::string& name, std::uint32_t offset, std::uint8_t type) {
  PointField field;
  field.name = name;
  field.offset = offset;
  field.datatype = type;
  field.count = 1;
  return field;
}

sensor_msgs::PointCloud2 to_velodyne_cloud(const SimSweep& sweep) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = to_ros_time(sweep.begin);
  cloud.header.frame_id = "lidar";
  cloud.fields = {make_field("x", kOffsetX, PointField::FLOAT32),
                  make_field("y", kOffsetX + 4, PointField::FLOAT32),
                  make_field("z", kOffsetX + 8, PointField::FLOAT32),
                  make_field("intensity", kOffsetIntensity, PointField::FLOAT32),
                  make_field("ring", kOffsetRing, PointField::UINT16),
                  make_field("time", kOffsetTime, PointField::FLOAT32)};
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(sweep.points.size());
  cloud.point_step = kPointStep;
  cloud.row_step = kPointStep * cloud.width;
  cloud.is_dense = true;
  cloud.data.resize(cloud.row_step);
  std::uint8_t* out = cloud.data.data();
  for (const SimPoint& point : sweep.points) {
    const float head[] = {point.x, point.y, point.z, point.intensity};
    std::memcpy(out + kOffsetX, head, sizeof head);
    std::memcpy(out + kOffsetRing, &point.ring, sizeof point.ring);
    std::memcpy(out + kOffsetTime, &point.time, sizeof point.time);
    out += kPointStep;
  }
  return cloud;
}

}  // namespace

BagWriter::BagWriter(const std::string& path) : bag_(std::make_unique<rosbag::Bag>()) {
  bag_->open(path, rosbag::bagmode::Write);
}

BagWriter::~BagWriter() = default;

void BagWriter::write_points(const SimSweep& sweep) {
  bag_->write("/points", to_ros_time(sweep.end), to_velodyne_cloud(sweep));
}

void BagWriter::write_imu(const ImuSample& sample, const std::string& topic) {
  sensor_msgs::Imu message;
  message.header.stamp = to_ros_time(sample.stamp);
  message.header.frame_id = "imu";
  message.orientation_covariance[0] = -1.0;  // says that there is no orientation
  message.angular_velocity = to_vector(sample.gyro);
  message.linear_acceleration = to_vector(sample.accel);
  bag_->write(topic, message.header.stamp, message);
}

void BagWriter::write_odometry(TimeNs stamp, const MotionState& state) {
  nav_msgs::Odometry message;
  message.header.stamp = to_ros_time(stamp);
  message.header.frame_id = "world";
  message.child_frame_id = "imu";
  message.pose.pose = to_pose(state.T_world_imu);
  message.twist.twist.linear = to_vector(state.T_world_imu.rotation.conjugate() * state.velocity_world);
  message.twist.twist.angular = to_vector(state.rate_imu);
  bag_->write("/ground_truth/odometry", message.header.stamp, message);
}

void BagWriter::close() { bag_->close(); }

}  // namespace allan_lio
