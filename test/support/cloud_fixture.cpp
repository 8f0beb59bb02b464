// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_fixture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
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

constexpr double kOtherClock = 7000.0;  // [s] at kFixtureStamp

double since_the_start(TimeNs) { return 0.0; }
double before_the_end(TimeNs) { return -kFixtureSweep; }
/// Rounded once: the step of such seconds is all that the tests allow for.
double of_the_clock(TimeNs stamp) {
  return static_cast<double>(stamp / kNsPerSecond) + 1e-9 * static_cast<double>(stamp % kNsPerSecond);
}
double of_the_clock_at_the_end(TimeNs stamp) { return of_the_clock(stamp - to_ns(kFixtureSweep)); }
double of_another_clock(TimeNs stamp) { return kOtherClock + 1e-9 * static_cast<double>(stamp - kFixtureStamp); }

bool is_integer(std::uint8_t type) { return type == kU32 || type == kUint64Code; }

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

const std::vector<FixtureUnit>& fixture_units() {
  static const std::vector<FixtureUnit> kUnits{{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}};
  return kUnits;
}

const std::vector<FixtureAnchor>& fixture_anchors() {
  static const std::vector<FixtureAnchor> kAnchors{
      {"since the start, stamped there", since_the_start, 0.0, PointTime::kAuto},
      {"since the start, stamped at the end", since_the_start, -kFixtureSweep, PointTime::kEnd},
      {"before the end, stamped there", before_the_end, -kFixtureSweep, PointTime::kAuto},
      {"of the clock, stamped at the start", of_the_clock, 0.0, PointTime::kAuto},
      {"of the clock, stamped at the end", of_the_clock_at_the_end, -kFixtureSweep, PointTime::kAuto},
      {"of another clock, stamped at the start", of_another_clock, 0.0, PointTime::kStart},
      {"of another clock, stamped at the end", of_another_clock, -kFixtureSweep, PointTime::kEnd},
  };
  return kAnchors;
}

const std::vector<std::uint8_t>& fixture_time_types() {
  static const std::vector<std::uint8_t> kTypes{kF32, kF64, kU32, kUint64Code};
  return kTypes;
}

double time_step(std::uint8_t type, const FixtureUnit& unit, double largest) {
  const double fine = type == kF32 ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
  // Integers too come to the fixture, and from the reader, as doubles.
  return std::max(is_integer(type) ? 1.0 / unit.per_second : 0.0, largest * fine);
}

bool holds(std::uint8_t type, const FixtureUnit& unit, const FixtureAnchor& anchor, TimeNs stamp) {
  const double zero = anchor.zero(stamp), largest = std::abs(zero) + kFixtureSweep;
  if (is_integer(type) && zero < 0.0) return false;
  // Where the zero is unknown anyway, a count that wraps does as well.
  if (anchor.told == PointTime::kAuto && type == kU32 && largest * unit.per_second > 4294967295.0) return false;
  return time_step(type, unit, largest) < 0.01 * kFixtureSweep + 1e-12;
}

double sweep_part(std::size_t point, std::size_t points) {
  return static_cast<double>(point) / static_cast<double>(points - 1);
}

std::vector<FixturePoint> sweep_points(std::size_t points, double zero, double per_second) {
  std::vector<FixturePoint> all;
  for (std::size_t i = 0; i < points; ++i)
    all.push_back({2.0F + 0.01F * static_cast<float>(i), -1.0F, 0.25F, static_cast<float>(i % 200),
                   (zero + kFixtureSweep * sweep_part(i, points)) * per_second});
  return all;
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
