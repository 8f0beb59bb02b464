// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/cloud_wire.h"

#include <gtest/gtest.h>
#include <sensor_msgs/PointCloud2.h>

#include <cstring>
#include <numeric>
#include <vector>

#include "allan_lio/ros/decode_cloud.h"

namespace allan_lio {
namespace {

// Where the counts of serialised() stand: after seq and stamp; height and width; and so on.
constexpr std::size_t kFrameCount = 12, kFieldCount = kFrameCount + 4 + 5 + 8, kNameCount = kFieldCount + 4,
                      kDataCount = kNameCount + 3 * (4 + 1 + 9) + 1 + 8;

sensor_msgs::PointCloud2 three_points() {
  sensor_msgs::PointCloud2 cloud;
  cloud.header.seq = 7;
  cloud.header.stamp = ros::Time(3, 4);
  cloud.header.frame_id = "lidar";
  cloud.height = 1;
  cloud.width = 3;
  cloud.point_step = 12;
  cloud.row_step = 36;
  cloud.data.resize(36);
  std::iota(cloud.data.begin(), cloud.data.end(), std::uint8_t{1});
  cloud.is_dense = 1;
  for (const char* name : {"x", "y", "z"}) {
    sensor_msgs::PointField field;
    field.name = name;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    cloud.fields.push_back(field);
  }
  return cloud;
}

std::vector<std::uint8_t> serialised() {
  const sensor_msgs::PointCloud2 cloud = three_points();
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(cloud));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, cloud);
  return bytes;
}

void expect_equal(const CloudView& view, const sensor_msgs::PointCloud2& cloud) {
  sensor_msgs::PointCloud2 whole = view.head;
  whole.data.assign(view.data, view.data + view.size);
  EXPECT_EQ(whole, cloud);
}

TEST(CloudWire, AWholeCloudIsOne) {
  const std::vector<std::uint8_t> bytes = serialised();
  const std::optional<CloudView> view = read_point_cloud(bytes.data(), bytes.size());
  ASSERT_TRUE(view);
  expect_equal(*view, three_points());
  const sensor_msgs::PointCloud2 cloud = three_points();
  expect_equal(view_of(cloud), cloud);
}

TEST(CloudWire, ThePointsAreLeftWhereTheyAre) {
  const std::vector<std::uint8_t> bytes = serialised();
  const std::optional<CloudView> view = read_point_cloud(bytes.data(), bytes.size());
  ASSERT_TRUE(view);
  EXPECT_EQ(view->data, bytes.data() + kDataCount + 4);
  EXPECT_TRUE(view->head.data.empty());
  const sensor_msgs::PointCloud2 cloud = three_points();
  EXPECT_EQ(view_of(cloud).data, cloud.data.data());
}

TEST(CloudWire, ACloudThatEndsAnywhereBeforeItsEndIsNone) {
  const std::vector<std::uint8_t> bytes = serialised();
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(read_point_cloud(bytes.data(), size)) << size;
}

TEST(CloudWire, CountsOfThingsThatAreNotThereAreRefused) {
  for (const std::size_t at : {kFrameCount, kFieldCount, kNameCount, kDataCount}) {
    for (const std::uint32_t lie : {0xFFFFFFFFU, 0x7FFFFFFFU, 1000000U}) {
      std::vector<std::uint8_t> bytes = serialised();
      std::memcpy(&bytes[at], &lie, sizeof lie);
      EXPECT_FALSE(read_point_cloud(bytes.data(), bytes.size())) << at << ": " << lie;
      LioConfig::Lidar lidar{};
      CloudDecoder decoder(lidar);
      const DecodedCloud decoded =
          decoder.decode(RawCloud{ros::message_traits::datatype<sensor_msgs::PointCloud2>(),
                                  ros::message_traits::md5sum<sensor_msgs::PointCloud2>(), bytes.data(), bytes.size()});
      EXPECT_FALSE(decoded.scan) << at << ": " << lie;
      EXPECT_NE(decoded.error.find("end before what its lengths announce"), std::string::npos) << decoded.error;
    }
  }
}

}  // namespace
}  // namespace allan_lio
