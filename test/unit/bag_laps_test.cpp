// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_laps.h"

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Float64.h>

#include <filesystem>

#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr int kSamples = 5;
constexpr std::uint32_t kStep = 200000000;  // between IMU samples [ns]
constexpr std::uint32_t kDelay = 3000000;   // of the recording after the stamp [ns]

ros::Time stamp_of_sample(int k) { return ros::Time(100, 0) + ros::Duration(1e-9 * kStep * k); }

/// Five IMU samples, a cloud in their midst, and a number without a header.
std::string write_bag(const std::string& file, int samples = kSamples) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  for (int k = 0; k < samples; ++k) {
    sensor_msgs::Imu imu;
    imu.header.stamp = stamp_of_sample(k);
    imu.linear_acceleration.z = k;
    bag.write("/imu", imu.header.stamp + ros::Duration(0, kDelay), imu);
  }
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = ros::Time(100, kStep / 2);
  bag.write("/points", cloud.header.stamp, cloud);
  std_msgs::Float64 number;
  number.data = 3.25;
  bag.write("/number", ros::Time(100, kStep / 2), number);
  return file;
}

TEST(BagLaps, EachLapGoesOnWhereTheOneBeforeEnded) {
  const TemporaryDirectory directory;
  BagLaps laps({write_bag(directory.file("lap.bag"))}, 3);
  laps.measure_by("imu");
  int samples = 0, clouds = 0, numbers = 0;
  for (BagMessage message; laps.next(message);) {
    if (message.connection->topic == "/imu") {
      const auto imu = message.as<sensor_msgs::Imu>();
      EXPECT_EQ(imu->header.stamp, stamp_of_sample(samples)) << "sample " << samples;
      EXPECT_EQ(message.time, imu->header.stamp + ros::Duration(0, kDelay));
      EXPECT_EQ(imu->linear_acceleration.z, samples % kSamples);
      ++samples;
    } else if (message.connection->topic == "/points") {
      EXPECT_EQ(message.as<sensor_msgs::PointCloud2>()->header.stamp,
                ros::Time(100, kStep / 2) + ros::Duration(1.0 * clouds));
      ++clouds;
    } else {
      EXPECT_EQ(message.as<std_msgs::Float64>()->data, 3.25) << "a message without a header is left as it is";
      EXPECT_EQ(message.time, ros::Time(100, kStep / 2) + ros::Duration(1.0 * numbers));
      ++numbers;
    }
  }
  EXPECT_EQ(samples, 3 * kSamples);
  EXPECT_EQ(clouds, 3);
  EXPECT_EQ(numbers, 3);
}

TEST(BagLaps, OneLapIsTheBagAsItIs) {
  const TemporaryDirectory directory;
  const std::string file = write_bag(directory.file("lap.bag"));
  BagLaps laps({file}, 1);
  BagSource source({file});
  BagMessage lap, plain;
  while (source.next(plain)) {
    ASSERT_TRUE(laps.next(lap));
    EXPECT_EQ(lap.time, plain.time);
    EXPECT_EQ(lap.bytes, plain.bytes);
  }
  EXPECT_FALSE(laps.next(lap));
}

TEST(BagLaps, ABagThatTellsNoLengthOrIsCutOffHasNoSecondLap) {
  const TemporaryDirectory directory;
  BagLaps single({write_bag(directory.file("single.bag"), 1)}, 2);
  single.measure_by("/imu");
  BagMessage message;
  EXPECT_THROW(while (single.next(message)){}, BagError);

  const std::string cut = write_bag(directory.file("cut.bag"));
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) - 40);
  BagLaps broken({cut}, 2);
  broken.measure_by("/imu");
  int messages = 0;
  while (broken.next(message)) ++messages;
  EXPECT_LE(messages, kSamples + 2);
  EXPECT_FALSE(broken.bags().troubles().empty());
}

}  // namespace
}  // namespace allan_lio
