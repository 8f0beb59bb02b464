// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// A point to be put into a cloud of some driver's layout.
struct FixturePoint {
  float x, y, z;         ///< [m]
  float intensity;       ///< 0 to 255
  double raw_time;       ///< what the time field holds, before it takes its type
  std::uint8_t tag = 0;  ///< Livox's
};

/// How a driver lays out its points.
struct FixtureLayout {
  struct Field {
    std::string name;
    std::uint8_t type;
    std::uint32_t offset;
  };
  std::string driver;
  std::vector<Field> fields;
  std::string time_field;
  std::uint32_t point_step;  ///< [bytes]
  std::uint32_t rows = 1;    ///< beams of an organised cloud
};

/// PCL's code for a field of 64-bit integers, which sensor_msgs/PointField does not have.
constexpr std::uint8_t kUint64Code = 10;

/// Velodyne, Ouster, Hesai, RoboSense, Livox (PointCloud2): names, types and places of the fields as
/// velodyne_pointcloud, ouster_ros, HesaiLidar_ROS, rslidar_sdk (XYZIRT) and livox_ros_driver2 publish them.
const std::vector<FixtureLayout>& driver_layouts();

/// A cloud in that layout, whose time field has this type (0: the driver's own; one that takes more room stands behind
/// all other fields). Organised, row by row, if the points fill the layout's rows. Numbers that the type does not hold
/// wrap as they do in a driver that casts them.
sensor_msgs::PointCloud2 make_cloud(const FixtureLayout& layout, std::uint8_t time_type, TimeNs stamp,
                                    const std::vector<FixturePoint>& points);

/// The bytes of a Livox CustomMsg; raw_time is offset_time [ns].
std::vector<std::uint8_t> livox_custom_bytes(TimeNs stamp, const std::string& frame,
                                             const std::vector<FixturePoint>& points);

/// The message's definition as the drivers publish it.
std::string livox_custom_definition();

}  // namespace allan_lio
