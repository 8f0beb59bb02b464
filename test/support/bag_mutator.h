// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <string>
#include <vector>

namespace allan_lio {

/// A message of a bag: an IMU's or a LiDAR's.
struct BagItem {
  ros::Time time;  ///< of its recording
  std::string topic;
  sensor_msgs::ImuPtr imu;            ///< else null
  sensor_msgs::PointCloud2Ptr cloud;  ///< else null
};

/// What comes in the place of a message: nothing, it itself (it may be changed: it is a copy of its own), or more.
/// `t`: of its recording, from the bag's begin [s].
using Mutation = std::function<std::vector<BagItem>(BagItem item, double t)>;

/// Writes the IMU's and the LiDAR's messages of a bag anew, each through all mutations in their order. Throws
/// rosbag::BagException.
void mutate_bag(const std::string& from, const std::string& to, const std::vector<Mutation>& mutations);

/// Writes the file's first part, 0 to 1 of its bytes.
void cut_file(const std::string& from, const std::string& to, double part);

/// Full scale of the gyro in the fault imu_saturated [rad/s].
constexpr double kClippedRate = 1.0;

/// Full scale of the accelerometer in the fault imu_saturated_accel [m/s^2].
constexpr double kClippedAccel = 12.0;

/// The fault of that name, as the rows of doc/faults.md call it. Every fault makes the same of the same bag. Throws
/// std::invalid_argument listing the names.
Mutation fault_by_name(const std::string& name);

}  // namespace allan_lio
