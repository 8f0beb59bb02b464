// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_bag.h"

namespace allan_lio {

BagSource open_lio_bags(const std::vector<std::string>& files, const LioConfig::Topics& topics) {
  BagSource bags(files);
  bags.require(topics.imu, {ros::message_traits::datatype<sensor_msgs::Imu>()});
  bags.require(topics.lidar, cloud_datatypes());
  bags.select({topics.imu, topics.lidar});
  return bags;
}

void take_lio_message(const BagMessage& message, const LioConfig::Topics& topics,
                      const std::function<void(const sensor_msgs::Imu&)>& on_imu,
                      const std::function<void(const RawCloud&)>& on_cloud) {
  const BagConnection& connection = *message.connection;
  const bool imu = same_topic(connection.topic, topics.imu);
  if (imu && connection.datatype == ros::message_traits::datatype<sensor_msgs::Imu>()) {
    on_imu(*message.as<sensor_msgs::Imu>());
  } else if (!imu) {
    on_cloud(to_raw_cloud(message));
  }
}

}  // namespace allan_lio
