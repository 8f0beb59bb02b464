// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/livox_custom.h"

#include <gtest/gtest.h>

#include <cstring>

#include "allan_lio/ros/decode_cloud.h"
#include "allan_lio/ros/raw_cloud.h"
#include "cloud_fixture.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStamp = 1600000000'250000000;
constexpr std::uint32_t kStepNs = 200'000;  // [ns] between points
constexpr std::size_t kPoints = 500;
constexpr std::size_t kPointSize = 19;                // [bytes]
constexpr std::size_t kFrameLengthAt = 12;            // [bytes]
constexpr std::size_t kCountAt = 16 + 6 + 8 + 4 + 4;  // behind "livox_", timebase, point_num, lidar_id and rsvd

std::vector<FixturePoint> points() {
  std::vector<FixturePoint> all;
  for (std::size_t i = 0; i < kPoints; ++i)
    all.push_back({2.0F + 0.01F * static_cast<float>(i), -1.0F, 0.25F, static_cast<float>(i % 256),
                   static_cast<double>(i * kStepNs)});
  return all;
}

std::vector<std::uint8_t> message() { return livox_custom_bytes(kStamp, "livox_", points()); }

LioConfig::Lidar options() {
  LioConfig::Lidar lidar{};
  lidar.deskew = true;
  lidar.drop_tagged = true;
  lidar.min_range = 0.5;
  lidar.max_range = 100.0;
  return lidar;
}

RawCloud raw(const std::vector<std::uint8_t>& bytes, const std::string& datatype = "livox_ros_driver/CustomMsg",
             const std::string& md5sum = kLivoxCustomMd5sum) {
  return {datatype, md5sum, bytes.data(), bytes.size()};
}

void set_length(std::vector<std::uint8_t>& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(&bytes[at], &value, sizeof value);
}

TEST(LivoxCustom, EveryPointIsReadWithItsTimeAndReflectivity) {
  for (const char* datatype : {"livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg"}) {
    const std::vector<std::uint8_t> bytes = message();
    CloudDecoder decoder(options());
    const DecodedCloud decoded = decoder.decode(raw(bytes, datatype));
    ASSERT_TRUE(decoded.scan) << decoded.error;
    EXPECT_EQ(decoded.scan->stamp, kStamp);
    ASSERT_EQ(decoded.scan->points.size(), kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
      const ScanPoint& p = decoded.scan->points[i];
      ASSERT_EQ(p.x, 2.0F + 0.01F * static_cast<float>(i));
      ASSERT_EQ(p.y, -1.0F);
      ASSERT_EQ(p.z, 0.25F);
      ASSERT_EQ(p.intensity, static_cast<float>(i % 256));
      ASSERT_EQ(p.offset_ns, static_cast<std::int32_t>(i * kStepNs));
    }
    EXPECT_NE(decoder.verdict().find("'offset_time' uint32 in ns since the sweep's start"), std::string::npos)
        << decoder.verdict();
  }
}

TEST(LivoxCustom, AFastSweepNeedsNoGuessOfItsUnit) {
  std::vector<FixturePoint> fast = points();
  for (FixturePoint& p : fast) p.raw_time /= 50.0;  // 2 ms in all
  const std::vector<std::uint8_t> bytes = livox_custom_bytes(kStamp, "livox_", fast);
  const DecodedCloud decoded = CloudDecoder(options()).decode(raw(bytes));
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->last_offset_ns, 1'996'000);
}

TEST(LivoxCustom, TheHeaderIsRead) {
  std::vector<std::uint8_t> bytes = message();
  EXPECT_EQ(frame_of(raw(bytes)), "livox_");
  EXPECT_EQ(stamp_of(raw(bytes)), kStamp);
  const std::uint32_t number = 4'000'000'000;
  std::memcpy(bytes.data(), &number, sizeof number);
  EXPECT_EQ(number_of(raw(bytes)), number);
  RawCloud cut = raw(bytes);
  cut.size = sizeof number - 1;
  EXPECT_FALSE(number_of(cut));
  std::string error;
  const auto read = read_livox_custom(bytes.data(), bytes.size(), error);
  ASSERT_TRUE(read) << error;
  EXPECT_EQ(read->timebase, kStamp);
  EXPECT_EQ(read->frame_id, "livox_");
}

TEST(LivoxCustom, TagsOfNoiseDropThePoint) {
  std::vector<FixturePoint> tagged = points();
  tagged[3].tag = 0x20;
  tagged[4].tag = 0x10;
  const std::vector<std::uint8_t> bytes = livox_custom_bytes(kStamp, "livox_", tagged);
  const DecodedCloud decoded = CloudDecoder(options()).decode(raw(bytes));
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->points.size(), kPoints - 1);
  EXPECT_EQ(decoded.scan->points[3].x, tagged[4].x);
}

TEST(LivoxCustom, AMessageThatIsCutAnywhereIsRefused) {
  const std::vector<std::uint8_t> whole = message();
  CloudDecoder decoder(options());
  for (std::size_t size = 0; size < whole.size(); size += size < 100 ? 1 : kPointSize - 1) {
    // Of exactly this size, so that a sanitizer sees a byte read behind it.
    const std::vector<std::uint8_t> cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    const DecodedCloud decoded = decoder.decode(raw(cut));
    ASSERT_FALSE(decoded.scan) << size;
    ASSERT_NE(decoded.error.find("bytes end before"), std::string::npos) << decoded.error;
  }
}

TEST(LivoxCustom, LengthsThatLieAreRefused) {
  for (const std::uint32_t lie : {std::uint32_t{kPoints} + 1, 0x7FFFFFFFU, 0xFFFFFFFFU, 0x0D79435EU}) {
    std::vector<std::uint8_t> count = message(), frame = message();
    set_length(count, kCountAt, lie);
    set_length(frame, kFrameLengthAt, lie > 1000000 ? lie : static_cast<std::uint32_t>(frame.size()));
    for (const auto& bytes : {count, frame}) {
      const DecodedCloud decoded = CloudDecoder(options()).decode(raw(bytes));
      EXPECT_FALSE(decoded.scan) << lie;
      EXPECT_NE(decoded.error.find("bytes end before"), std::string::npos) << decoded.error;
    }
  }
}

TEST(LivoxCustom, AnotherVersionAndAnotherTypeAreRefusedByName) {
  const std::vector<std::uint8_t> bytes = message();
  CloudDecoder decoder(options());
  const std::string version = decoder.decode(raw(bytes, "livox_ros_driver2/CustomMsg", "0123")).error;
  EXPECT_NE(version.find("another version of livox_ros_driver2/CustomMsg"), std::string::npos) << version;
  const std::string type = decoder.decode(raw(bytes, "sensor_msgs/LaserScan")).error;
  EXPECT_NE(type.find("sensor_msgs/LaserScan"), std::string::npos) << type;
  EXPECT_NE(type.find("livox_ros_driver/CustomMsg"), std::string::npos) << type;
}

TEST(LivoxCustom, PointCloud2ThroughTheSameEntryGivesTheSameScan) {
  std::vector<FixturePoint> all = points();
  const sensor_msgs::PointCloud2 cloud =
      make_cloud(driver_layouts().front(), sensor_msgs::PointField::UINT32, kStamp, all);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(cloud));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, cloud);
  const RawCloud of_bytes = raw(bytes, "sensor_msgs/PointCloud2", ros::message_traits::md5sum(cloud));
  const DecodedCloud a = CloudDecoder(options()).decode(of_bytes), b = CloudDecoder(options()).decode(cloud);
  ASSERT_TRUE(a.scan && b.scan) << a.error << b.error;
  ASSERT_EQ(a.scan->points.size(), kPoints);
  EXPECT_EQ(std::memcmp(a.scan->points.data(), b.scan->points.data(), kPoints * sizeof(ScanPoint)), 0);

  bytes.resize(bytes.size() / 2);
  const DecodedCloud cut = CloudDecoder(options()).decode(raw(bytes, of_bytes.datatype, of_bytes.md5sum));
  EXPECT_FALSE(cut.scan);
  EXPECT_NE(cut.error.find("bytes end before"), std::string::npos) << cut.error;
}

}  // namespace
}  // namespace allan_lio
