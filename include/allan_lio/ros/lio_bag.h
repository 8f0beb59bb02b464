// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Imu.h>

#include <functional>
#include <string>
#include <vector>

#include "allan_lio/lio/lio_config.h"
#include "allan_lio/ros/bag_source.h"
#include "allan_lio/ros/raw_cloud.h"

namespace allan_lio {

/// Bags, merged by time, of which only the IMU's and the LiDAR's messages come. Throws BagError if one cannot be read
/// or a topic is missing or of another type.
BagSource open_lio_bags(const std::vector<std::string>& files, const LioConfig::Topics& topics);

/// Takes what came from a bag of open_lio_bags(): clouds of any type, for a decoder to judge. Throws
/// ros::serialization::StreamOverrunException for an IMU's damaged bytes.
void take_lio_message(const BagMessage& message, const LioConfig::Topics& topics,
                      const std::function<void(const sensor_msgs::Imu&)>& on_imu,
                      const std::function<void(const RawCloud&)>& on_cloud);

}  // namespace allan_lio
