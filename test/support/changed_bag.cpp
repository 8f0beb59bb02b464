// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "changed_bag.h"

#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <topic_tools/shape_shifter.h>

#include <cstring>
#include <stdexcept>

#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/livox_custom.h"

namespace allan_lio {
namespace {

std::vector<FixturePoint> points_of(const sensor_msgs::PointCloud2& cloud, double zero, double per_second) {
  std::vector<FixturePoint> points;
  for (std::size_t at = 0; at < cloud.data.size(); at += cloud.point_step) {
    const auto number = [&](std::size_t field) {
      float value;
      std::memcpy(&value, &cloud.data[at + cloud.fields[field].offset], sizeof value);
      return value;
    };
    std::size_t time = 0;
    while (cloud.fields[time].name != "time") ++time;
    points.push_back({number(0), number(1), number(2), number(3), zero + per_second * number(time)});
  }
  return points;
}

topic_tools::ShapeShifter to_livox(const sensor_msgs::PointCloud2& cloud) {
  const TimeNs stamp = to_time_ns(cloud.header.stamp);
  std::vector<std::uint8_t> bytes = livox_custom_bytes(stamp, "livox_frame", points_of(cloud, 0.0, 1e9));
  topic_tools::ShapeShifter message;
  message.morph(kLivoxCustomMd5sum, "livox_ros_driver2/CustomMsg", livox_custom_definition(), "0");
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.read(stream);
  return message;
}

}  // namespace

void change_bag(const std::string& from, const std::string& to, const BagChange& change) {
  rosbag::Bag in(from, rosbag::bagmode::Read), out(to, rosbag::bagmode::Write);
  rosbag::View view(in);
  for (const rosbag::MessageInstance& message : view) {
    if ((message.getTime() - view.getBeginTime()).toSec() > change.duration) break;
    const std::string& topic = message.getTopic();
    if (const auto imu = message.instantiate<sensor_msgs::Imu>()) {
      if (!change.imu || change.imu(*imu)) out.write(topic, message.getTime(), *imu);
    } else if (const auto cloud = message.instantiate<sensor_msgs::PointCloud2>()) {
      if (change.cloud && !change.cloud(*cloud)) continue;
      if (change.livox_custom)
        out.write(topic, message.getTime(), to_livox(*cloud));
      else
        out.write(topic, message.getTime(), *cloud);
    }
  }
}

sensor_msgs::PointCloud2 in_layout(const sensor_msgs::PointCloud2& cloud, const FixtureLayout& layout, double zero,
                                   double per_second) {
  return make_cloud(layout, 0, to_time_ns(cloud.header.stamp), points_of(cloud, zero, per_second));
}

const FixtureLayout& layout_of(const std::string& driver) {
  for (const FixtureLayout& layout : driver_layouts())
    if (layout.driver == driver) return layout;
  throw std::logic_error("no layout of " + driver);
}

}  // namespace allan_lio
