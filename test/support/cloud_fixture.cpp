// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_fixture.h"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

using sensor_msgs::PointField;
constexpr auto kF32 = PointField::FLOAT32;
constexpr auto kF64 = PointField::FLOAT64;
constexpr auto kU8 = PointField::UINT8;
constexpr auto kU16 = PointField::UINT16;
constexpr auto kU32 = PointField::UINT32;

void put(std::uint8_t* to, std::uint8_t type, double value) {
  const auto as = [to](auto number) { std::memcpy(to, &number, sizeof number); };
  const auto whole = static_cast<std::int64_t>(value);
  switch (type) {
    case kU8:
      return as(static_cast<std::uint8_t>(whole));
    case kU16:
      return as(static_cast<std::uint16_t>(whole));
    case kU32:
      return as(static_cast<std::uint32_t>(whole));
    case kUint64Code:
      return as(static_cast<std::uint64_t>(whole));
    case kF32:
      return as(static_cast<float>(value));
    case kF64:
      return as(value);
    default:
      throw std::logic_error("type not used here");
  }
}

double value_of(const std::string& field, const std::string& time_field, const FixturePoint& p) {
  if (field == time_field) return p.raw_time;
  if (field == "x") return p.x;
  if (field == "y") return p.y;
  if (field == "z") return p.z;
  if (field == "tag") return p.tag;
  if (field == "range") return std::isfinite(p.x) ? 1e3 * std::hypot(p.x, p.y, p.z) : 0.0;  // [mm]
  return field == "ring" || field == "line" ? 3.0 : p.intensity;
}

/// Another type in the field's place, or behind all else where it takes more room than the driver's own.
void retype(std::uint8_t type, PointField& field, std::uint32_t& point_step) {
  const bool wider = type >= kF64 && field.datatype < kF64;
  field.datatype = type;
  if (!wider) return;
  field.offset = point_step;
  point_step += sizeof(double);
}

template <class T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof value);
  std::memcpy(&bytes[at], &value, sizeof value);
}

}  // namespace

const std::vector<FixtureLayout>& driver_layouts() {
  static const std::vector<FixtureLayout> kLayouts{
      {"velodyne",
       {{"x", kF32, 0},
        {"y", kF32, 4},
        {"z", kF32, 8},
        {"intensity", kF32, 12},
        {"ring", kU16, 16},
        {"time", kF32, 18}},
       "time",
       22},
      {"ouster",
       {{"x", kF32, 0},
        {"y", kF32, 4},
        {"z", kF32, 8},
        {"intensity", kF32, 16},
        {"t", kU32, 20},
        {"reflectivity", kU16, 24},
        {"ring", kU16, 26},
        {"ambient", kU16, 28},
        {"range", kU32, 32}},
       "t",
       48,
       64},
      {"hesai",
       {{"x", kF32, 0},
        {"y", kF32, 4},
        {"z", kF32, 8},
        {"intensity", kF32, 16},
        {"timestamp", kF64, 24},
        {"ring", kU16, 32}},
       "timestamp",
       48},
      {"robosense",
       {{"x", kF32, 0},
        {"y", kF32, 4},
        {"z", kF32, 8},
        {"intensity", kF32, 12},
        {"ring", kU16, 16},
        {"timestamp", kF64, 18}},
       "timestamp",
       26},
      {"livox",
       {{"x", kF32, 0},
        {"y", kF32, 4},
        {"z", kF32, 8},
        {"intensity", kF32, 12},
        {"tag", kU8, 16},
        {"line", kU8, 17},
        {"timestamp", kF64, 18}},
       "timestamp",
       26},
  };
  return kLayouts;
}

sensor_msgs::PointCloud2 make_cloud(const FixtureLayout& layout, std::uint8_t time_type, TimeNs stamp,
                                    const std::vector<FixturePoint>& points) {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = to_ros_time(stamp);
  cloud.header.frame_id = "lidar";
  const auto count = static_cast<std::uint32_t>(points.size());
  cloud.height = count > 0 && count % layout.rows == 0 ? layout.rows : 1;
  cloud.width = count / cloud.height;
  cloud.point_step = layout.point_step;
  for (const FixtureLayout::Field& field : layout.fields) {
    PointField to;
    to.name = field.name;
    to.offset = field.offset;
    to.datatype = field.type;
    to.count = 1;
    if (field.name == layout.time_field && time_type != 0) retype(time_type, to, cloud.point_step);
    cloud.fields.push_back(to);
  }
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.data.assign(std::size_t{cloud.row_step} * cloud.height, 0xAB);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const PointField& field : cloud.fields)
      put(&cloud.data[i * cloud.point_step + field.offset], field.datatype,
          value_of(field.name, layout.time_field, points[i]));
  return cloud;
}

std::vector<std::uint8_t> livox_custom_bytes(TimeNs stamp, const std::string& frame,
                                             const std::vector<FixturePoint>& points) {
  std::vector<std::uint8_t> bytes;
  append(bytes, std::uint32_t{7});  // sequence number
  append(bytes, static_cast<std::uint32_t>(stamp / kNsPerSecond));
  append(bytes, static_cast<std::uint32_t>(stamp % kNsPerSecond));
  append(bytes, static_cast<std::uint32_t>(frame.size()));
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  append(bytes, static_cast<std::uint64_t>(stamp));  // timebase
  append(bytes, static_cast<std::uint32_t>(points.size()));
  append(bytes, std::uint32_t{0});  // lidar_id, rsvd
  append(bytes, static_cast<std::uint32_t>(points.size()));
  for (const FixturePoint& p : points) {
    append(bytes, static_cast<std::uint32_t>(p.raw_time));
    append(bytes, p.x), append(bytes, p.y), append(bytes, p.z);
    append(bytes, static_cast<std::uint8_t>(p.intensity));
    append(bytes, p.tag);
    append(bytes, std::uint8_t{3});  // line
  }
  return bytes;
}

std::string livox_custom_definition() {
  const std::string line(80, '=');
  return "std_msgs/Header header\nuint64 timebase\nuint32 point_num\nuint8 lidar_id\nuint8[3] rsvd\n"
         "CustomPoint[] points\n" +
         line + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + line +
         "\nMSG: livox_ros_driver/CustomPoint\nuint32 offset_time\nfloat32 x\nfloat32 y\nfloat32 z\n"
         "uint8 reflectivity\nuint8 tag\nuint8 line\n";
}

}  // namespace allan_lio
