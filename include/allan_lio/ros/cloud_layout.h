// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "allan_lio/lidar/point_time.h"
#include "allan_lio/ros/cloud_wire.h"

namespace allan_lio {

/// Where a number stands inside a point.
struct CloudField {
  std::string name;
  NumberType type = NumberType::kFloat32;
  std::uint32_t offset = 0;  ///< [bytes]
};

/// A PointCloud2 whose header has been checked against its bytes: every point and field lies inside `data`.
struct CloudLayout {
  const std::uint8_t* data = nullptr;
  std::size_t rows = 0, columns = 0;
  std::size_t row_step = 0, point_step = 0;  ///< [bytes]
  CloudField x, y, z;
  std::optional<CloudField> intensity, time;
  std::optional<CloudField> tag;         ///< Livox's remark on the point
  TimeUnit time_unit = TimeUnit::kAuto;  ///< if the message's type says it

  std::size_t points() const { return rows * columns; }
};

/// Checks the header and finds the fields. `time_field`: name of the point time, empty to find it. An empty cloud
/// gives a layout without points. Otherwise nothing, and `error` is a sentence.
std::optional<CloudLayout> read_layout(const CloudView& cloud, const std::string& time_field, std::string& error);

/// A number of type T at any address.
template <class T>
T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

inline double load_number(const std::uint8_t* from, NumberType type) {
  switch (type) {
    case NumberType::kInt8:
      return load<std::int8_t>(from);
    case NumberType::kUint8:
      return load<std::uint8_t>(from);
    case NumberType::kInt16:
      return load<std::int16_t>(from);
    case NumberType::kUint16:
      return load<std::uint16_t>(from);
    case NumberType::kInt32:
      return load<std::int32_t>(from);
    case NumberType::kUint32:
      return load<std::uint32_t>(from);
    case NumberType::kFloat32:
      return load<float>(from);
    case NumberType::kFloat64:
      return load<double>(from);
    case NumberType::kInt64:
      return static_cast<double>(load<std::int64_t>(from));
    case NumberType::kUint64:
      return static_cast<double>(load<std::uint64_t>(from));
  }
  return 0.0;
}

}  // namespace allan_lio
