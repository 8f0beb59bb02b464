// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/param_source.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>

#include "simulated_drive.h"

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

XmlRpcValue list_of_a_list() {
  XmlRpcValue list;
  list.setSize(1);
  list[0].setSize(1);
  list[0][0] = 1;
  return list;
}

XmlRpcValue date() {
  std::tm day{};
  day.tm_year = 126;
  day.tm_mday = 1;
  return XmlRpcValue(&day);
}

/// What reading the tree as a configuration complains of.
std::string complaint(const XmlRpcValue& tree) {
  try {
    read_config(merge(to_source(simulated_robot()), flatten_parameters(tree, "/n")));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(ParamSource, what_has_no_text_is_refused_by_name_and_leaves_the_others_alone) {
  for (const XmlRpcValue& senseless : {list_of_a_list(), date()}) {
    XmlRpcValue tree;
    tree["imu"]["k_g"] = senseless;
    tree["imu"]["k_gb"] = 2;
    tree["topics"]["imu"] = senseless;  // where any text will do
    const ConfigSource source = flatten_parameters(tree, "/n");
    EXPECT_NE(source.at("imu/k_g").senseless, "");
    EXPECT_NE(source.at("topics/imu").senseless, "");
    EXPECT_EQ(source.at("imu/k_gb").senseless, "");
    EXPECT_EQ(source.at("imu/k_gb").items, std::vector<std::string>{"2"});
    EXPECT_NE(complaint(tree).find("/n/imu/k_g"), std::string::npos) << complaint(tree);
    XmlRpcValue topic;
    topic["topics"]["imu"] = senseless;
    EXPECT_NE(complaint(topic).find("/n/topics/imu"), std::string::npos) << complaint(topic);
  }
}

XmlRpcValue empty_tree() {
  int offset = 0;
  return XmlRpcValue("<value><struct></struct></value>", &offset);
}

TEST(ParamSource, an_empty_tree_is_no_value_of_a_parameter_and_a_group_may_be_one) {
  XmlRpcValue tree;
  tree["imu"]["k_gb"] = empty_tree();
  EXPECT_NE(complaint(tree).find("imu/k_gb"), std::string::npos) << complaint(tree);
  EXPECT_NE(complaint(tree).find("has no value"), std::string::npos) << complaint(tree);
  XmlRpcValue group;
  group["imu"] = empty_tree();
  EXPECT_EQ(complaint(group), "");
  EXPECT_TRUE(flatten_parameters(empty_tree(), "/n").empty());
}

}  // namespace
}  // namespace allan_lio
