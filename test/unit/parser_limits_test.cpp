// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Sizes that no honest file or message has.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/known_keys.h"
#include "allan_lio/io/line_reader.h"
#include "allan_lio/ros/decode_cloud.h"
#include "allan_lio/ros/livox_custom.h"
#include "allocation_count.h"
#include "changed_bag.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

TEST(ParserLimits, AKeyOfMegabytesIsRefusedWithTheNearestOneLikeAnyOther) {
  ConfigSource source;
  source["map/voxel_siz" + std::string(std::size_t{4} << 20U, 'e')] = ConfigEntry{{"1"}, false, "huge.yaml:1"};
  try {
    refuse_unknown_keys(source);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("is not a parameter; the nearest one is '"), std::string::npos);
  }
}

TEST(ParserLimits, ALineMayBeLongerThanTheBufferAndNotLongerThanAMegabyte) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("lines");
  const std::string longest((std::size_t{1} << 20U) - 1, 'x');
  std::ofstream(path) << "first\n" << longest << "\nlast\n";
  LineReader lines(path);
  TextLine line;
  ASSERT_TRUE(lines.next(line));
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(std::string(line.begin, line.end), longest);
  ASSERT_TRUE(lines.next(line));
  EXPECT_EQ(std::string(line.begin, line.end), "last");
  EXPECT_FALSE(lines.next(line));

  std::ofstream(path) << longest << "xx\n";
  LineReader too_long(path);
  EXPECT_THROW(too_long.next(line), std::runtime_error);
}

constexpr std::size_t kFewBytes = 4096;  // for a sentence; a lie of the tests' would take megabytes
constexpr std::uint32_t kLies[] = {0xFFFFFFFFU, 0x7FFFFFFFU, 1000000U};
constexpr TimeNs kStamp = 1600000000 * kNsPerSecond;

std::vector<FixturePoint> three_points() { return {{1, 2, 3, 4, 0}, {2, 2, 3, 4, 5e7}, {3, 2, 3, 4, 1e8}}; }

/// Refused, and next to nothing is allocated before that.
template <class Cloud>
void expect_cheap_refusal(const Cloud& cloud) {
  LioConfig::Lidar lidar{};
  lidar.max_range = 100.0;
  CloudDecoder decoder(lidar);
  const std::size_t before = *bytes_allocated();
  const DecodedCloud decoded = decoder.decode(cloud);
  const std::size_t taken = *bytes_allocated() - before;
  EXPECT_FALSE(decoded.scan);
  EXPECT_NE(decoded.error, "");
  EXPECT_LT(taken, kFewBytes) << decoded.error;
}

/// Each count of 32 bits in turn becomes a lie.
void expect_lies_refused(const std::string& type, const std::string& md5sum, const std::vector<std::uint8_t>& honest,
                         const std::vector<std::size_t>& counts) {
  for (const std::size_t at : counts) {
    for (const std::uint32_t lie : kLies) {
      SCOPED_TRACE(type + ", byte " + std::to_string(at) + ": " + std::to_string(lie));
      std::vector<std::uint8_t> bytes = honest;
      std::memcpy(&bytes[at], &lie, sizeof lie);
      expect_cheap_refusal(RawCloud{type, md5sum, bytes.data(), bytes.size()});
    }
  }
}

class LyingMessages : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!bytes_allocated()) GTEST_SKIP() << "not counted under a sanitizer";
    const std::size_t before = *bytes_allocated();
    const std::vector<char> megabyte(std::size_t{1} << 20U);
    ASSERT_GE(*bytes_allocated() - before, megabyte.size()) << "the count does not count";
  }
};

TEST_F(LyingMessages, APointCloudsBytesMakeRoomForNothingThatIsNotThere) {
  const sensor_msgs::PointCloud2 cloud = make_cloud(layout_of("velodyne"), 0, kStamp, three_points());
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(cloud));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, cloud);
  constexpr std::size_t kFrame = 4 + 8;
  const std::size_t fields = kFrame + 4 + cloud.header.frame_id.size() + 8, name = fields + 4;
  const std::size_t data = bytes.size() - 1 - cloud.data.size() - 4;
  expect_lies_refused(ros::message_traits::datatype(cloud), ros::message_traits::md5sum(cloud), bytes,
                      {kFrame, fields, name, data});
}

TEST_F(LyingMessages, ALivoxMessagesBytesMakeRoomForNothingThatIsNotThere) {
  const std::string frame = "livox_frame";
  constexpr std::size_t kFrame = 4 + 8;
  const std::size_t points = kFrame + 4 + frame.size() + 8 + 4 + 4;
  expect_lies_refused("livox_ros_driver2/CustomMsg", kLivoxCustomMd5sum,
                      livox_custom_bytes(kStamp, frame, three_points()), {kFrame, points});
}

TEST_F(LyingMessages, ADecodedCloudsHeaderMakesRoomForNoPointsThatAreNotThere) {
  using Cloud = sensor_msgs::PointCloud2;
  const std::vector<std::function<void(Cloud&, std::uint32_t)>> headers{
      [](Cloud& cloud, std::uint32_t lie) { cloud.width = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.height = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.width = cloud.height = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.point_step = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.height = cloud.row_step = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.height = lie, cloud.row_step = 0; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.fields[0].offset = lie; },
      [](Cloud& cloud, std::uint32_t lie) { cloud.width = lie, cloud.point_step = 0; },
  };
  for (std::size_t i = 0; i < headers.size(); ++i) {
    for (const std::uint32_t lie : kLies) {
      SCOPED_TRACE("header " + std::to_string(i) + ": " + std::to_string(lie));
      Cloud cloud = make_cloud(layout_of("velodyne"), 0, kStamp, three_points());
      headers[i](cloud, lie);
      expect_cheap_refusal(cloud);
    }
  }
}

}  // namespace
}  // namespace allan_lio
