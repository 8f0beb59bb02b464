// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/decode_cloud.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

namespace allan_lio {
namespace {

using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;

constexpr int kPoints = 1000;
constexpr double kSweep = 0.1;          // [s]
constexpr std::int32_t kFloatNs = 5;    // [ns], float32 at 0.1 s
constexpr std::int32_t kEpochNs = 500;  // [ns], float64 seconds since 1970

LioConfig::Lidar options() {
  LioConfig::Lidar lidar{};
  lidar.deskew = true;
  lidar.point_time = PointTime::kAuto;
  lidar.time_unit = TimeUnit::kAuto;
  lidar.min_range = 0.5;
  lidar.max_range = 100.0;
  return lidar;
}

struct FieldSpec {
  const char* name;
  std::uint8_t type;
  std::uint32_t offset;
};

void put(PointCloud2& cloud, int point, std::size_t field, double value) {
  std::uint8_t* to = &cloud.data[static_cast<std::size_t>(point) * cloud.point_step + cloud.fields[field].offset];
  const auto as = [&](auto number) { std::memcpy(to, &number, sizeof number); };
  switch (cloud.fields[field].datatype) {
    case PointField::UINT8:
      return as(static_cast<std::uint8_t>(value));
    case PointField::UINT16:
      return as(static_cast<std::uint16_t>(value));
    case PointField::UINT32:
      return as(static_cast<std::uint32_t>(value));
    case PointField::FLOAT32:
      return as(static_cast<float>(value));
    case PointField::FLOAT64:
      return as(value);
    default:
      FAIL() << "type not used here";
  }
}

double time_fraction(int point) { return static_cast<double>(point) / (kPoints - 1); }

/// kPoints points at 2 m and more; field 3 is the intensity, field 4 the time.
PointCloud2 make_cloud(const std::vector<FieldSpec>& fields, std::uint32_t step,
                       const std::function<double(double)>& time) {
  PointCloud2 cloud;
  cloud.header.stamp = ros::Time(1600000000, 250000000);
  cloud.height = 1;
  cloud.width = kPoints;
  cloud.point_step = step;
  cloud.row_step = step * kPoints;
  cloud.data.assign(cloud.row_step, 0xAB);
  for (const FieldSpec& spec : fields) {
    PointField field;
    field.name = spec.name;
    field.datatype = spec.type;
    field.offset = spec.offset;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  for (int i = 0; i < kPoints; ++i) {
    put(cloud, i, 0, 2.0 + 0.01 * i);
    put(cloud, i, 1, -1.0);
    put(cloud, i, 2, 0.25);
    put(cloud, i, 3, i % 200);
    if (fields.size() > 4) put(cloud, i, 4, time(time_fraction(i)));
  }
  return cloud;
}

constexpr auto kF32 = PointField::FLOAT32;
constexpr auto kF64 = PointField::FLOAT64;

PointCloud2 velodyne() {
  return make_cloud({{"x", kF32, 0},
                     {"y", kF32, 4},
                     {"z", kF32, 8},
                     {"intensity", kF32, 12},
                     {"time", kF32, 18},
                     {"ring", PointField::UINT16, 16}},
                    22, [](double s) { return kSweep * s; });
}
PointCloud2 old_velodyne() {
  return make_cloud({{"x", kF32, 0}, {"y", kF32, 4}, {"z", kF32, 8}, {"intensity", kF32, 16}, {"time", kF32, 24}}, 32,
                    [](double s) { return kSweep * (s - 1.0); });
}
PointCloud2 ouster() {
  return make_cloud({{"x", kF32, 0},
                     {"y", kF32, 4},
                     {"z", kF32, 8},
                     {"intensity", kF32, 16},
                     {"t", PointField::UINT32, 20},
                     {"reflectivity", PointField::UINT16, 24}},
                    48, [](double s) { return std::round(1e9 * kSweep * s); });
}
PointCloud2 hesai() {
  return make_cloud({{"x", kF32, 0}, {"y", kF32, 4}, {"z", kF32, 8}, {"intensity", kF32, 16}, {"timestamp", kF64, 24}},
                    48, [](double s) { return 1600000000.25 + kSweep * s; });
}
PointCloud2 robosense() {
  return make_cloud({{"x", kF32, 0},
                     {"y", kF32, 4},
                     {"z", kF32, 8},
                     {"intensity", PointField::UINT8, 12},
                     {"timestamp", kF64, 18},
                     {"ring", PointField::UINT16, 16}},
                    26, [](double s) { return 1600000000.25 + kSweep * s; });
}

DecodedCloud decode(const PointCloud2& cloud, const LioConfig::Lidar& lidar = options()) {
  CloudDecoder decoder(lidar);
  return decoder.decode(cloud);
}

void expect_all_points(const PointCloud2& cloud, double first, double last, std::int32_t tolerance) {
  const DecodedCloud decoded = decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  const Scan& scan = *decoded.scan;
  EXPECT_EQ(scan.stamp, 1600000000'250000000);
  ASSERT_EQ(scan.points.size(), static_cast<std::size_t>(kPoints));
  EXPECT_EQ(scan.dropped_invalid + scan.dropped_range, 0U);
  EXPECT_NEAR(scan.first_offset_ns, 1e9 * first, tolerance);
  EXPECT_NEAR(scan.last_offset_ns, 1e9 * last, tolerance);
  for (int i = 0; i < kPoints; ++i) {
    const ScanPoint& point = scan.points[static_cast<std::size_t>(i)];
    EXPECT_EQ(point.x, static_cast<float>(2.0 + 0.01 * i));
    EXPECT_EQ(point.y, -1.0F);
    EXPECT_EQ(point.z, 0.25F);
    EXPECT_EQ(point.intensity, static_cast<float>(i % 200));
    EXPECT_NEAR(point.offset_ns, 1e9 * (first + (last - first) * time_fraction(i)), tolerance);
  }
}

TEST(DecodeCloud, velodyne) { expect_all_points(velodyne(), 0.0, kSweep, kFloatNs); }
TEST(DecodeCloud, velodyne_stamped_at_the_end) { expect_all_points(old_velodyne(), -kSweep, 0.0, kFloatNs); }
TEST(DecodeCloud, ouster) { expect_all_points(ouster(), 0.0, kSweep, 1); }
TEST(DecodeCloud, hesai) { expect_all_points(hesai(), 0.0, kSweep, kEpochNs); }
TEST(DecodeCloud, robosense) { expect_all_points(robosense(), 0.0, kSweep, kEpochNs); }

TEST(DecodeCloud, positions_may_be_float64_and_rows_padded) {
  PointCloud2 cloud =
      make_cloud({{"x", kF64, 0}, {"y", kF64, 8}, {"z", kF64, 16}, {"intensity", kF32, 24}, {"time", kF32, 28}}, 32,
                 [](double s) { return kSweep * s; });
  PointCloud2 padded = cloud;
  padded.height = 10;
  padded.width = kPoints / 10;
  padded.row_step = 32 * padded.width + 64;
  padded.data.assign(padded.row_step * padded.height, 0x00);
  for (std::uint32_t row = 0; row < padded.height; ++row)
    std::memcpy(&padded.data[row * padded.row_step], &cloud.data[row * 32 * padded.width], 32 * padded.width);
  expect_all_points(cloud, 0.0, kSweep, kFloatNs);
  expect_all_points(padded, 0.0, kSweep, kFloatNs);
}

TEST(DecodeCloud, the_time_offset_moves_the_stamp_and_nothing_else) {
  LioConfig::Lidar lidar = options();
  lidar.time_offset = -0.02;
  const DecodedCloud decoded = decode(hesai(), lidar);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->stamp, 1600000000'230000000);
  EXPECT_NEAR(decoded.scan->last_offset_ns, 1e9 * kSweep, kEpochNs);
}

TEST(DecodeCloud, a_start_given_in_so_many_words_puts_the_smallest_time_at_the_stamp) {
  LioConfig::Lidar lidar = options();
  lidar.point_time = PointTime::kStart;
  const PointCloud2 other_clock =
      make_cloud({{"x", kF32, 0}, {"y", kF32, 4}, {"z", kF32, 8}, {"intensity", kF32, 12}, {"timestamp", kF64, 16}}, 24,
                 [](double s) { return 7000.0 + kSweep * (1.0 - s); });
  const DecodedCloud decoded = decode(other_clock, lidar);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->first_offset_ns, 0);
  EXPECT_NEAR(decoded.scan->last_offset_ns, 1e9 * kSweep, kFloatNs);
  EXPECT_NEAR(decoded.scan->points.front().offset_ns, 1e9 * kSweep, kFloatNs);
  lidar.point_time = PointTime::kEnd;
  EXPECT_EQ(decode(other_clock, lidar).scan->last_offset_ns, 0);
}

TEST(DecodeCloud, invalid_and_far_points_are_dropped_and_counted) {
  PointCloud2 cloud = velodyne();
  put(cloud, 0, 0, std::numeric_limits<double>::quiet_NaN());
  put(cloud, 1, 1, std::numeric_limits<double>::infinity());
  for (const std::size_t field : {0U, 1U, 2U}) put(cloud, 2, field, 0.0);
  put(cloud, 3, 4, std::numeric_limits<double>::quiet_NaN());
  put(cloud, 4, 4, 1e20);
  put(cloud, 5, 0, 0.1), put(cloud, 5, 1, 0.1);
  put(cloud, 6, 0, 200.0);
  put(cloud, 7, 0, 1e30);
  CloudDecoder decoder(options());
  ASSERT_TRUE(decoder.decode(velodyne()).scan);
  const DecodedCloud decoded = decoder.decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->dropped_invalid, 5U);
  EXPECT_EQ(decoded.scan->dropped_range, 3U);
  EXPECT_EQ(decoded.scan->points.size(), static_cast<std::size_t>(kPoints - 8));
  EXPECT_NEAR(decoded.scan->last_offset_ns, 1e9 * kSweep, kFloatNs);
}

TEST(DecodeCloud, padding_without_position_does_not_spoil_the_verdict) {
  PointCloud2 cloud = hesai();
  for (int i = 0; i < 50; ++i)
    for (const std::size_t field : {0U, 1U, 2U, 4U}) put(cloud, i, field, 0.0);
  const DecodedCloud decoded = decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->dropped_invalid, 50U);
  EXPECT_GT(decoded.scan->first_offset_ns, 0);
}

TEST(DecodeCloud, without_intensity_it_is_zero) {
  PointCloud2 cloud = velodyne();
  cloud.fields[3].name = "reflectance";
  const DecodedCloud decoded = decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->points.back().intensity, 0.0F);
}

TEST(DecodeCloud, a_missing_time_field_is_refused_unless_deskew_is_off) {
  PointCloud2 cloud = velodyne();
  cloud.fields[4].name = "azimuth";
  const DecodedCloud refused = decode(cloud);
  ASSERT_FALSE(refused.scan);
  EXPECT_NE(refused.error.find("azimuth"), std::string::npos) << refused.error;
  EXPECT_NE(refused.error.find("lidar/deskew"), std::string::npos) << refused.error;

  LioConfig::Lidar lidar = options();
  lidar.deskew = false;
  const DecodedCloud decoded = decode(cloud, lidar);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->last_offset_ns, 0);
  EXPECT_EQ(decoded.scan->points.back().offset_ns, 0);

  lidar = options();
  lidar.time_field = "azimuth";
  EXPECT_TRUE(decode(cloud, lidar).scan);
  lidar.time_field = "moment";
  EXPECT_NE(decode(cloud, lidar).error.find("'moment'"), std::string::npos);
}

TEST(DecodeCloud, equal_times_are_refused) {
  PointCloud2 cloud = velodyne();
  for (int i = 0; i < kPoints; ++i) put(cloud, i, 4, 0.0);
  const DecodedCloud decoded = decode(cloud);
  ASSERT_FALSE(decoded.scan);
  EXPECT_NE(decoded.error.find("same time"), std::string::npos) << decoded.error;
}

TEST(DecodeCloud, an_empty_cloud_is_an_empty_scan) {
  PointCloud2 cloud;
  const DecodedCloud decoded = decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_TRUE(decoded.scan->points.empty());
}

TEST(DecodeCloud, headers_that_lie_are_refused) {
  struct Lie {
    const char* what;
    std::function<void(PointCloud2&)> tell;
  };
  const std::vector<Lie> lies{
      {"width beyond the data", [](PointCloud2& c) { c.width += 1; }},
      {"huge width", [](PointCloud2& c) { c.width = 0xFFFFFFFF; }},
      {"huge width and height", [](PointCloud2& c) { c.width = c.height = c.row_step = 0xFFFFFFFF; }},
      {"height beyond the data", [](PointCloud2& c) { c.height = 2; }},
      {"huge height", [](PointCloud2& c) { c.height = 0xFFFFFFFF; }},
      {"no point_step", [](PointCloud2& c) { c.point_step = 0; }},
      {"huge point_step", [](PointCloud2& c) { c.point_step = 0xFFFFFFFF; }},
      {"row_step below a row", [](PointCloud2& c) { c.height = 2, c.width /= 2, c.row_step = 10; }},
      {"no data", [](PointCloud2& c) { c.data.clear(); }},
      {"cut data", [](PointCloud2& c) { c.data.pop_back(); }},
      {"x past the step", [](PointCloud2& c) { c.fields[0].offset = c.point_step - 3; }},
      {"huge offset", [](PointCloud2& c) { c.fields[4].offset = 0xFFFFFFFE; }},
      {"intensity past the step", [](PointCloud2& c) { c.fields[3].offset = c.point_step; }},
      {"unknown type", [](PointCloud2& c) { c.fields[4].datatype = 99; }},
      {"x of integers", [](PointCloud2& c) { c.fields[0].datatype = PointField::INT32; }},
      {"mixed position types", [](PointCloud2& c) { c.fields[0].datatype = PointField::FLOAT64; }},
      {"no z", [](PointCloud2& c) { c.fields[2].name = "height"; }},
      {"big-endian", [](PointCloud2& c) { c.is_bigendian = true; }},
  };
  for (const Lie& lie : lies) {
    PointCloud2 cloud = velodyne();
    lie.tell(cloud);
    const DecodedCloud decoded = decode(cloud);
    EXPECT_FALSE(decoded.scan) << lie.what;
    EXPECT_FALSE(decoded.error.empty()) << lie.what;
  }
}

}  // namespace
}  // namespace allan_lio
