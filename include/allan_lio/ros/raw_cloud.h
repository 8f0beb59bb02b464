// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <topic_tools/shape_shifter.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/math/time.h"
#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// A message of a LiDAR's topic, of whatever type its publisher says it is. Does not own the bytes.
struct RawCloud {
  std::string datatype, md5sum;
  const std::uint8_t* bytes = nullptr;
  std::size_t size = 0;
};

enum class CloudKind { kPointCloud2, kLivoxCustom };

/// The types that are read: sensor_msgs/PointCloud2 and the CustomMsg of Livox's two drivers.
const std::vector<std::string>& cloud_datatypes();

/// Nothing for a type that is not read, or for another version of one that is; `error` says so.
std::optional<CloudKind> cloud_kind(const RawCloud& cloud, std::string& error);

/// The header's number (seq), with which all these types begin; nothing if the bytes end before its end.
std::optional<std::uint32_t> number_of(const RawCloud& cloud);

/// The header's stamp; nothing if the bytes end before it.
std::optional<TimeNs> stamp_of(const RawCloud& cloud);

/// The header's frame_id; empty if the bytes end before it.
std::string frame_of(const RawCloud& cloud);

RawCloud to_raw_cloud(const BagMessage& message);

/// `storage` is given the bytes, and must outlive the result.
RawCloud to_raw_cloud(const topic_tools::ShapeShifter& message, std::vector<std::uint8_t>& storage);

}  // namespace allan_lio
