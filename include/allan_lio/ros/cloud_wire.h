// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstddef>
#include <cstdint>
#include <optional>

namespace allan_lio {

/// A cloud whose points are left where they are. Does not own them.
struct CloudView {
  sensor_msgs::PointCloud2 head;  ///< all of the message but its `data`, which is empty
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;  ///< of the data [bytes]
};

/// Reads the bytes of a sensor_msgs/PointCloud2. Nothing if they do not hold a whole one. Every count in it is checked
/// first, for ros::serialization makes room for as many things as a count says before it looks whether they are there,
/// gigabytes for a count that lies. The bytes must outlive the result.
std::optional<CloudView> read_point_cloud(const std::uint8_t* bytes, std::size_t size);

/// The message must outlive the result.
CloudView view_of(const sensor_msgs::PointCloud2& cloud);

}  // namespace allan_lio
