// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/imu_bag.h"

#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Temperature.h>
#include <std_msgs/String.h>

#include <fstream>

#include "allan_lio/ros/bag_stream.h"
#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr int kMessages = 3000;

sensor_msgs::Imu imu_message(int i) {
  sensor_msgs::Imu imu;
  imu.header.seq = static_cast<std::uint32_t>(i);
  imu.header.stamp =
      ros::Time(100 + static_cast<std::uint32_t>(i / 100), static_cast<std::uint32_t>(i % 100) * 10000000);
  imu.header.frame_id = "imu_link";
  imu.angular_velocity.x = i;
  imu.angular_velocity.y = -1;
  imu.angular_velocity.z = 0.25 * i;
  imu.linear_acceleration.x = 1;
  imu.linear_acceleration.y = 2;
  imu.linear_acceleration.z = 9.8 + i;
  imu.orientation_covariance[0] = 5;
  imu.angular_velocity_covariance[8] = 6;
  imu.linear_acceleration_covariance[8] = 7;
  return imu;
}

class ImuBagTest : public ::testing::Test {
 protected:
  /// Several chunks of readings with other topics between.
  std::string write_bag(const std::string& name,
                        rosbag::CompressionType compression = rosbag::compression::Uncompressed,
                        const std::string& topic = "/imu/data", int first = 0) {
    const std::string file = directory_.file(name);
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setCompression(compression);
    bag.setChunkThreshold(100000);
    for (int i = first; i < first + kMessages; ++i) {
      const sensor_msgs::Imu imu = imu_message(i);
      bag.write(topic, imu.header.stamp, imu);
      std_msgs::String note;
      note.data = "note";
      if (i % 3 == 0) bag.write("/note", imu.header.stamp, note);
      sensor_msgs::Temperature temperature;
      temperature.temperature = 25.0 + 0.001 * i;
      if (i % 10 == 0) bag.write("/imu/temperature", imu.header.stamp, temperature);
    }
    bag.close();
    return file;
  }

  ImuBagOutcome read(const std::vector<std::string>& bags, const std::string& topic = "",
                     const std::string& temperature_topic = "") {
    samples_.clear();
    temperatures_.clear();
    return read_imu_bags({bags, topic, temperature_topic},
                         {[this](const ImuSample& sample) { samples_.push_back(sample); },
                          [this](double value) { temperatures_.push_back(value); }});
  }

  std::string error_of(const std::vector<std::string>& bags, const std::string& topic = "") {
    try {
      read(bags, topic);
    } catch (const BagError& error) {
      return error.what();
    }
    return "no error";
  }

  void expect_samples(std::size_t count) const {
    ASSERT_EQ(samples_.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_EQ(samples_[i].stamp, 100 * kNsPerSecond + static_cast<TimeNs>(i) * 10'000'000);
      EXPECT_EQ(samples_[i].gyro, Eigen::Vector3d(static_cast<double>(i), -1, 0.25 * static_cast<double>(i)));
      EXPECT_EQ(samples_[i].accel, Eigen::Vector3d(1, 2, 9.8 + static_cast<double>(i)));
    }
  }

  static void overwrite(const std::string& file, const std::string& before, std::size_t after, std::size_t bytes) {
    std::string content = contents_of(file);
    const std::size_t at = content.find(before);
    ASSERT_NE(at, std::string::npos);
    content.replace(at + before.size() + after, bytes, bytes, '\0');
    std::ofstream(file, std::ios::binary) << content;
  }

  TemporaryDirectory directory_;
  std::vector<ImuSample> samples_;
  std::vector<double> temperatures_;
};

TEST_F(ImuBagTest, EveryCompressionGivesTheSameReadings) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const ImuBagOutcome outcome = read({write_bag("imu.bag", compression)}, "", "imu/temperature");
    EXPECT_EQ(outcome.topic, "/imu/data");
    EXPECT_TRUE(outcome.troubles.empty()) << outcome.troubles.front();
    EXPECT_EQ(outcome.undecodable, 0);
    expect_samples(kMessages);
    ASSERT_EQ(temperatures_.size(), static_cast<std::size_t>(kMessages / 10));
    EXPECT_DOUBLE_EQ(temperatures_.back(), 25.0 + 0.001 * (kMessages - 10));
  }
}

TEST_F(ImuBagTest, BagsFollowOneAnother) {
  const std::string first = write_bag("1.bag"),
                    second = write_bag("2.bag", rosbag::compression::LZ4, "imu/data", kMessages);
  read({first, second});
  expect_samples(2 * kMessages);
}

TEST_F(ImuBagTest, ABagThatWasNeverClosedIsReadAndSaidToBe) {
  const std::string file = write_bag("open.bag");
  overwrite(file, "index_pos=", 0, 8);
  const ImuBagOutcome outcome = read({file});
  expect_samples(kMessages);
  ASSERT_EQ(outcome.troubles.size(), 1U);
  EXPECT_NE(outcome.troubles[0].find("open.bag was not closed"), std::string::npos);
}

TEST_F(ImuBagTest, ACutBagIsReadAsFarAsItGoes) {
  for (const auto compression : {rosbag::compression::Uncompressed, rosbag::compression::LZ4}) {
    const std::string file = write_bag("cut.bag", compression);
    const std::string content = contents_of(file);
    std::ofstream(file, std::ios::binary) << content.substr(0, content.size() * 6 / 10);
    const ImuBagOutcome outcome = read({file});
    EXPECT_GT(samples_.size(), 1000U);
    EXPECT_LT(samples_.size(), 2500U);
    expect_samples(samples_.size());
    ASSERT_EQ(outcome.troubles.size(), 1U);
    EXPECT_NE(outcome.troubles[0].find("cut.bag"), std::string::npos);
  }
}

TEST_F(ImuBagTest, DamagedBytesNeverCrash) {
  const std::string content = contents_of(write_bag("whole.bag"));
  const std::string file = directory_.file("damaged.bag");
  for (std::size_t i = 0; i < 300; ++i) {
    std::string damaged = content;
    const std::size_t at = 13 + (i * 7919) % (i < 100 ? 8000 : content.size() - 30);
    for (std::size_t k = 0; k < 9; ++k) damaged[at + k] = static_cast<char>(i * 31 + k * 101);
    std::ofstream(file, std::ios::binary) << damaged;
    try {
      read({file});
    } catch (const BagError&) {
    }
    EXPECT_LE(samples_.size(), static_cast<std::size_t>(kMessages));
  }
}

TEST_F(ImuBagTest, TopicsThatCannotBeReadAreNamed) {
  const std::string file = write_bag("imu.bag");
  EXPECT_NE(error_of({file}, "/imu").find("there is no topic /imu; of type sensor_msgs/Imu: /imu/data"),
            std::string::npos);
  EXPECT_NE(error_of({file}, "/note").find("topic /note is of type std_msgs/String, not sensor_msgs/Imu"),
            std::string::npos);
  const std::string other = write_bag("other.bag", rosbag::compression::Uncompressed, "/imu2");
  EXPECT_NE(error_of({file, other}).find("several topics of type sensor_msgs/Imu"), std::string::npos);
  EXPECT_EQ(error_of({file, other}, "imu2"), "no error");
  EXPECT_NE(error_of({directory_.file("absent.bag")}).find("absent.bag"), std::string::npos);
  std::ofstream(directory_.file("text.bag")) << "this is no bag at all";
  EXPECT_NE(error_of({directory_.file("text.bag")}).find("text.bag is not a bag"), std::string::npos);
  EXPECT_NE(error_of({directory_.path()}).find("bag"), std::string::npos);
}

TEST(DecodeImu, IsWhatRosDeserialises) {
  sensor_msgs::Imu message = imu_message(77);
  for (const std::string& frame : {std::string(), std::string("imu"), std::string(100, 'f')}) {
    message.header.frame_id = frame;
    std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
    ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::serialize(stream, message);
    ImuSample sample;
    ASSERT_TRUE(decode_imu(bytes.data(), bytes.size(), &sample));
    EXPECT_EQ(sample.stamp, static_cast<TimeNs>(message.header.stamp.toNSec()));
    EXPECT_EQ(sample.gyro, Eigen::Vector3d(77, -1, 19.25));
    EXPECT_EQ(sample.accel, Eigen::Vector3d(1, 2, 9.8 + 77));
    for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(decode_imu(bytes.data(), size, &sample));
  }
}

}  // namespace
}  // namespace allan_lio
