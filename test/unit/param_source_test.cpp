// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/param_source.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace allan_lio {
namespace {

using XmlRpc::XmlRpcValue;

TEST(ParamSource, a_tree_becomes_keys_with_slashes_and_says_where_it_stood) {
  XmlRpcValue tree;
  tree["imu"]["k_gb"] = 2;
  tree["imu"]["noise"]["gyro_white_noise"]["unit"] = "deg/sqrt(h)";
  tree["lidar"]["deskew"] = false;
  const ConfigSource source = flatten_parameters(tree, "/lidar_odometry");
  ASSERT_EQ(source.size(), 3U);
  EXPECT_EQ(source.at("imu/k_gb").items, std::vector<std::string>{"2"});
  EXPECT_EQ(source.at("imu/k_gb").origin, "rosparam /lidar_odometry/imu/k_gb");
  EXPECT_EQ(source.at("imu/noise/gyro_white_noise/unit").items, std::vector<std::string>{"deg/sqrt(h)"});
  EXPECT_EQ(source.at("lidar/deskew").items, std::vector<std::string>{"false"});
}

TEST(ParamSource, numbers_keep_every_bit) {
  const double value = 0.1 + 0.2;
  XmlRpcValue tree;
  tree["lidar"]["leaf"] = value;
  const std::string text = flatten_parameters(tree, "/n").at("lidar/leaf").items.front();
  EXPECT_EQ(std::strtod(text.c_str(), nullptr), value);
}

TEST(ParamSource, lists_stay_lists) {
  XmlRpcValue tree;
  XmlRpcValue& list = tree["extrinsics"]["T_imu_lidar"]["translation"];
  list.setSize(3);
  list[0] = 1;
  list[1] = 0.5;
  list[2] = -2;
  const ConfigEntry entry = flatten_parameters(tree, "/n").at("extrinsics/T_imu_lidar/translation");
  EXPECT_TRUE(entry.is_list);
  EXPECT_EQ(entry.items, (std::vector<std::string>{"1", "0.5", "-2"}));
}

TEST(ParamSource, what_has_no_text_is_refused_by_name) {
  XmlRpcValue tree;
  XmlRpcValue& list = tree["imu"]["k_g"];
  list.setSize(1);
  list[0].setSize(1);
  list[0][0] = 1;
  try {
    flatten_parameters(tree, "/n");
    FAIL() << "no exception";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("/n/imu/k_g"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace allan_lio
