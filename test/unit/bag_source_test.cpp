// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/bag_source.h"

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <std_msgs/String.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

constexpr int kMessages = 400;

class BagSourceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/allan_lio_bag_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    directory_ = name;
  }
  void TearDown() override {
    for (const std::string& file : files_) std::remove(file.c_str());
    rmdir(directory_.c_str());
  }

  std::string path(const std::string& name) {
    files_.push_back(directory_ + "/" + name);
    return files_.back();
  }

  /// Many small chunks; /imu in the order of time, "note" late on purpose.
  std::string write_bag(const std::string& name, rosbag::CompressionType compression, int first_second = 100) {
    const std::string file = path(name);
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setCompression(compression);
    bag.setChunkThreshold(10000);
    std::mt19937_64 random(1);
    for (int i = 0; i < kMessages; ++i) {
      sensor_msgs::Imu imu;
      imu.header.seq = static_cast<std::uint32_t>(i);
      imu.linear_acceleration.z = 9.8 + i;
      for (double& element : imu.orientation_covariance) element = random();  // leaves compression little to do
      bag.write("/imu", ros::Time(static_cast<std::uint32_t>(first_second + i), 5), imu);
      std_msgs::String note;
      note.data = std::string(40, 'n') + std::to_string(i);
      if (i % 3 == 0) bag.write("note", ros::Time(static_cast<std::uint32_t>(first_second + i - 30), 7), note);
    }
    bag.close();
    return file;
  }

  std::string copy_of(const std::string& file, const std::string& name, double part) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream all;
    all << in.rdbuf();
    const std::string bytes = all.str();
    const std::string to = path(name);
    std::ofstream(to, std::ios::binary) << bytes.substr(0, static_cast<std::size_t>(part * bytes.size()));
    return to;
  }

  /// Overwrites the position of the index, as a recorder leaves it that was killed.
  static void forget_index(const std::string& file) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    std::string head(4096, '\0');
    stream.read(&head[0], static_cast<std::streamsize>(head.size()));
    const std::size_t at = head.find("index_pos=");
    ASSERT_NE(at, std::string::npos);
    stream.seekp(static_cast<std::streamoff>(at + 10));
    stream.write("\0\0\0\0\0\0\0\0", 8);
  }

  std::string directory_;
  std::vector<std::string> files_;
};

std::vector<BagMessage> read_all(BagSource& source) {
  std::vector<BagMessage> all;
  BagMessage message;
  while (source.next(message)) all.push_back(message);
  return all;
}

void expect_same(const std::vector<BagMessage>& a, const std::vector<BagMessage>& b, std::size_t count) {
  ASSERT_GE(a.size(), count);
  ASSERT_GE(b.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(a[i].time, b[i].time) << i;
    EXPECT_EQ(a[i].connection->topic, b[i].connection->topic) << i;
    EXPECT_EQ(a[i].connection->md5sum, b[i].connection->md5sum) << i;
    EXPECT_EQ(a[i].connection->definition, b[i].connection->definition) << i;
    EXPECT_EQ(a[i].bytes, b[i].bytes) << i;
  }
}

TEST_F(BagSourceTest, messages_come_in_the_order_of_time_and_say_what_they_are) {
  BagSource source({write_bag("whole.bag", rosbag::compression::Uncompressed)});
  const std::vector<BagMessage> all = read_all(source);
  EXPECT_EQ(all.size(), static_cast<std::size_t>(kMessages + (kMessages + 2) / 3));
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].time, all[i].time);
  int next = 0;
  for (const BagMessage& message : all) {
    if (message.connection->datatype != "sensor_msgs/Imu") continue;
    EXPECT_EQ(message.as<sensor_msgs::Imu>()->linear_acceleration.z, 9.8 + next++);
  }
  EXPECT_TRUE(source.troubles().empty());
}

TEST_F(BagSourceTest, a_bag_without_index_gives_the_same_messages_and_says_so) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const std::string file = write_bag("bag" + std::to_string(compression), compression);
    BagSource whole({file});
    const std::vector<BagMessage> expected = read_all(whole);
    forget_index(file);
    BagSource salvaged({file});
    const std::vector<BagMessage> found = read_all(salvaged);
    EXPECT_EQ(found.size(), expected.size());
    expect_same(found, expected, expected.size());
    ASSERT_EQ(salvaged.troubles().size(), 1U);
    EXPECT_NE(salvaged.troubles().front().find("no usable index"), std::string::npos);
  }
}

TEST_F(BagSourceTest, a_time_beyond_all_that_ros_knows_is_held_and_costs_no_message) {
  const std::string file = write_bag("wild.bag", rosbag::compression::Uncompressed);
  forget_index(file);
  std::ifstream in(file, std::ios::binary);
  std::stringstream all;
  all << in.rdbuf();
  std::string bytes = all.str();
  // The last second's time with a second and more of nanoseconds: the nearest that there is.
  const std::uint32_t usual[] = {150, 5}, wild[] = {0xffffffffU, 4000000000U};
  const std::string of_message(reinterpret_cast<const char*>(usual), sizeof usual);
  std::size_t at = bytes.find("time=" + of_message);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 5, of_message.size(), reinterpret_cast<const char*>(wild), sizeof wild);
  std::ofstream(file, std::ios::binary) << bytes;
  BagSource source({file});
  const std::vector<BagMessage> found = read_all(source);
  EXPECT_EQ(found.size(), static_cast<std::size_t>(kMessages + (kMessages + 2) / 3));
  EXPECT_EQ(found.back().time, ros::Time(0xffffffffU, 999999999U));
  EXPECT_GT(seconds_between(source.begin(), source.end()), 4e9);
}

TEST_F(BagSourceTest, a_bag_that_is_cut_off_gives_what_there_is) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::BZ2, rosbag::compression::LZ4}) {
    const std::string name = "cut" + std::to_string(compression);
    const std::string file = write_bag(name, compression);
    std::size_t before = 0;
    for (const double part : {0.2, 0.4, 0.6}) {
      BagSource cut({copy_of(file, name + "_" + std::to_string(before), part)});
      cut.select({"/imu"});
      const std::vector<BagMessage> found = read_all(cut);
      EXPECT_GT(found.size(), before) << part;
      EXPECT_LT(found.size(), static_cast<std::size_t>(kMessages));
      for (std::size_t i = 0; i < found.size(); ++i)
        EXPECT_EQ(found[i].as<sensor_msgs::Imu>()->linear_acceleration.z, 9.8 + static_cast<double>(i));
      EXPECT_EQ(cut.troubles().size(), 1U);
      before = found.size();
    }
  }
}

TEST_F(BagSourceTest, several_bags_are_merged_by_time) {
  const std::string late = write_bag("late.bag", rosbag::compression::Uncompressed, 1000);
  const std::string early = write_bag("early.bag", rosbag::compression::Uncompressed, 700);
  BagSource source({late, early});
  source.select({"imu"});
  const std::vector<BagMessage> all = read_all(source);
  EXPECT_EQ(all.size(), 2U * kMessages);
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LE(all[i - 1].time, all[i].time);
  EXPECT_EQ(source.begin(), ros::Time(670, 7));
  EXPECT_EQ(source.end(), ros::Time(1399, 5));
}

std::string refusal_of(const std::string& file) {
  try {
    BagSource source({file});
  } catch (const BagError& error) {
    return error.what();
  }
  return "";
}

TEST_F(BagSourceTest, what_is_no_bag_is_refused_by_name) {
  const std::string text = path("text.bag"), empty = path("empty.bag");
  std::ofstream(text) << "this is some text, not a recording";
  std::ofstream(empty).flush();
  for (const std::string& file : {text, empty, directory_ + "/none.bag"})
    EXPECT_NE(refusal_of(file).find(file), std::string::npos) << refusal_of(file);
}

TEST_F(BagSourceTest, a_missing_topic_is_named_with_those_there_are) {
  BagSource source({write_bag("topics.bag", rosbag::compression::Uncompressed)});
  EXPECT_NO_THROW(source.require("imu", {"sensor_msgs/Imu"}));
  try {
    source.require("/imu/data", {"sensor_msgs/Imu"});
    FAIL() << "no exception";
  } catch (const BagError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("/imu/data"), std::string::npos) << text;
    EXPECT_NE(text.find("sensor_msgs/Imu: /imu"), std::string::npos) << text;
  }
  EXPECT_THROW(source.require("/imu", {"sensor_msgs/PointCloud2"}), BagError);
}

}  // namespace
}  // namespace allan_lio
