// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "child_process.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

const std::string kRoot = ALLAN_LIO_SOURCE_DIR;

std::vector<std::string> launch_files() {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(kRoot + "/launch"))
    if (entry.path().extension() == ".launch") files.push_back(entry.path().string());
  return files;
}

/// Everything that the pattern's first group catches.
std::set<std::string> all_of(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}

TEST(LaunchFiles, EachIsExpandedByRoslaunchToItsNodes) {
  ASSERT_FALSE(launch_files().empty());
  for (const std::string& file : launch_files()) {
    const bool needs_bag = contents_of(file).find("<arg name=\"bag\" doc=") != std::string::npos;
    const Outcome nodes = run_command("ROS_PACKAGE_PATH=" + kRoot + ":$ROS_PACKAGE_PATH roslaunch --nodes " + file +
                                      " rviz:=true k_gb:=2 out:=results" + (needs_bag ? " bag:=drive.bag" : ""));
    EXPECT_EQ(nodes.status, 0) << file << ": " << nodes.text;
    for (const char* node : {"/lidar_odometry", "/imu_propagation", "/lio_manager", "/rviz"})
      EXPECT_NE(nodes.text.find(node), std::string::npos) << file << ": " << nodes.text;
  }
}

TEST(LaunchFiles, NameOnlyExecutablesNodeletsAndFilesThatExist) {
  const std::set<std::string> nodelets = all_of(contents_of(kRoot + "/nodelet_plugins.xml"), "class name=\"([^\"]+)\"");
  EXPECT_EQ(nodelets.size(), 2U);
  for (const std::string& file : launch_files()) {
    const std::string text = contents_of(file);
    for (const std::string& type : all_of(text, "pkg=\"allan_lio\"\\s+type=\"([^\"]+)\""))
      EXPECT_TRUE(fs::exists(ALLAN_LIO_BIN_DIR "/" + type)) << file << " runs " << type;
    for (const std::string& name : all_of(text, "args=\"load (\\S+)"))
      EXPECT_EQ(nodelets.count(name), 1U) << file << " loads " << name;
    for (const std::string& path : all_of(text, "\\$\\(find allan_lio\\)/([^\"\\s]+)"))
      EXPECT_TRUE(fs::exists(kRoot + "/" + path)) << file << " refers to " << path;
  }
}

TEST(LaunchFiles, TheirDefaultConfigurationIsOneThatShips) {
  for (const std::string& file : launch_files())
    for (const std::string& name : all_of(contents_of(file), "name=\"config\" default=\"([^\"]+)\""))
      EXPECT_TRUE(fs::exists(kRoot + "/config/robots/" + name + ".yaml")) << file << ": " << name;
}

}  // namespace
}  // namespace allan_lio
