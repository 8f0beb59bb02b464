// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <string>

#include "cloud_fixture.h"

namespace allan_lio {

/// What becomes of the messages of a bag of simulate_bag. What gives false is left out.
struct BagChange {
  std::function<bool(sensor_msgs::Imu&)> imu = {};
  std::function<bool(sensor_msgs::PointCloud2&)> cloud = {};
  bool livox_custom = false;  ///< clouds become livox_ros_driver2/CustomMsg
  double duration = 1e9;      ///< of what is taken over [s]
};

void change_bag(const std::string& from, const std::string& to, const BagChange& change);

/// The cloud of simulate_bag (Velodyne's fields) in another driver's layout, its times as that driver gives them:
/// `zero` + time times `per_second`.
sensor_msgs::PointCloud2 in_layout(const sensor_msgs::PointCloud2& cloud, const FixtureLayout& layout, double zero,
                                   double per_second);

/// driver_layouts() by name.
const FixtureLayout& layout_of(const std::string& driver);

}  // namespace allan_lio
