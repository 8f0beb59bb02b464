// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace allan_lio {

/// True if the bytes hold a whole sensor_msgs/PointCloud2: every count in them is of things that are there.
/// ros::serialization makes room for as many things as a count says before it looks whether they are there, gigabytes
/// for a count that lies: ask this first.
bool holds_point_cloud(const std::uint8_t* bytes, std::size_t size);

}  // namespace allan_lio
