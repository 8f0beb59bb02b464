// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/lio/lio_config.h"
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

constexpr double kFixtureSweep = 0.1;                   // [s]
constexpr TimeNs kFixtureStamp = 1600000000'250000000;  // [ns] of a first sweep

/// What a time field counts in.
struct FixtureUnit {
  const char* name;
  double per_second;
};
const std::vector<FixtureUnit>& fixture_units();

/// What a time field counts from, where the stamp stands in the sweep, and what the configuration says of it.
struct FixtureAnchor {
  const char* name;
  double (*zero)(TimeNs stamp);  ///< the field's value at the sweep's begin [s]
  double begin;                  ///< of the sweep less the stamp [s]
  PointTime told;
};
const std::vector<FixtureAnchor>& fixture_anchors();

/// The types that drivers give a time field, as sensor_msgs/PointField and kUint64Code number them.
const std::vector<std::uint8_t>& fixture_time_types();

/// The step in which a field of this type counts times as large as these [s].
double time_step(std::uint8_t type, const FixtureUnit& unit, double largest);

/// Whether the type holds the times of a sweep with this stamp at all, and finely enough.
bool holds(std::uint8_t type, const FixtureUnit& unit, const FixtureAnchor& anchor, TimeNs stamp);

/// The part of a sweep that is over at a point [1].
double sweep_part(std::size_t point, std::size_t points);

/// A sweep of so many points, the field's value at its begin `zero` [s].
std::vector<FixturePoint> sweep_points(std::size_t points, double zero, double per_second);

/// The bytes of a Livox CustomMsg; raw_time is offset_time [ns].
std::vector<std::uint8_t> livox_custom_bytes(TimeNs stamp, const std::string& frame,
                                             const std::vector<FixturePoint>& points);

/// The message's definition as the drivers publish it.
std::string livox_custom_definition();

}  // namespace allan_lio
