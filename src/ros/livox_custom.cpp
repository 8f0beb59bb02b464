// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/livox_custom.h"

namespace allan_lio {
namespace {

// Header header, uint64 timebase, uint32 point_num, uint8 lidar_id, uint8[3] rsvd, CustomPoint[] points; a point is
// uint32 offset_time, float32 x, y, z, uint8 reflectivity, tag, line, without gaps.
constexpr std::size_t kSequenceSize = 4, kStampSize = 8, kCountSize = 4;
constexpr std::size_t kFixedSize = 8 + 4 + 1 + 3;  // timebase, point_num, lidar_id, rsvd
constexpr std::uint32_t kOffsetTime = 0, kOffsetX = 4, kOffsetY = 8, kOffsetZ = 12, kOffsetReflectivity = 16,
                        kOffsetTag = 17, kPointSize = 19;

CloudLayout point_layout(const std::uint8_t* points, std::size_t count) {
  CloudLayout layout;
  layout.data = points;
  layout.rows = 1;
  layout.columns = count;
  layout.point_step = kPointSize;
  layout.row_step = count * kPointSize;
  layout.x = {"x", NumberType::kFloat32, kOffsetX};
  layout.y = {"y", NumberType::kFloat32, kOffsetY};
  layout.z = {"z", NumberType::kFloat32, kOffsetZ};
  layout.intensity = CloudField{"reflectivity", NumberType::kUint8, kOffsetReflectivity};
  layout.time = CloudField{"offset_time", NumberType::kUint32, kOffsetTime};
  layout.time_unit = TimeUnit::kNanoseconds;
  layout.tag = CloudField{"tag", NumberType::kUint8, kOffsetTag};
  return layout;
}

}  // namespace

std::optional<LivoxCustom> read_livox_custom(const std::uint8_t* bytes, std::size_t size, std::string& error) {
  const auto too_short = [&] {
    error = "the CustomMsg's " + std::to_string(size) + " bytes end before what its lengths announce";
    return std::nullopt;
  };
  error.clear();
  std::size_t at = kSequenceSize + kStampSize + kCountSize;
  if (size < at) return too_short();
  const std::size_t name_size = load<std::uint32_t>(bytes + at - kCountSize);
  if (name_size > size - at || kFixedSize + kCountSize > size - at - name_size) return too_short();
  LivoxCustom message;
  message.stamp = TimeNs{load<std::uint32_t>(bytes + kSequenceSize)} * kNsPerSecond +
                  load<std::uint32_t>(bytes + kSequenceSize + sizeof(std::uint32_t));
  message.frame_id.assign(reinterpret_cast<const char*>(bytes + at), name_size);
  at += name_size;
  message.timebase = static_cast<TimeNs>(load<std::uint64_t>(bytes + at));
  at += kFixedSize;
  const std::size_t count = load<std::uint32_t>(bytes + at);
  at += kCountSize;
  if (count > (size - at) / kPointSize) return too_short();
  message.layout = point_layout(bytes + at, count);
  return message;
}

}  // namespace allan_lio
