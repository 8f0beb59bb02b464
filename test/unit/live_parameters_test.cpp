// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/live_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "simulated_drive.h"

namespace allan_lio {
namespace {

ConfigEntry text(const std::string& value) { return {{value}, false, "a test"}; }

std::string refusal(const std::string& key, const std::string& value) {
  try {
    change_live(simulated_robot(), key, text(value));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(LiveParameters, the_multipliers_are_among_them_and_the_map_is_not) {
  std::vector<std::string> keys;
  for (const ParameterEntry& entry : live_parameters(simulated_robot())) keys.push_back(entry.info.key);
  for (const char* key : {"imu/k_g", "imu/k_a", "imu/k_gb", "imu/k_ab", "lidar/k_r"})
    EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 1) << key;
  for (const char* key : {"map/voxel_size", "topics/imu", "imu/bias_model", "lidar/range_noise", "threads"})
    EXPECT_EQ(std::count(keys.begin(), keys.end(), key), 0) << key;
}

TEST(LiveParameters, a_change_changes_that_parameter_and_nothing_else) {
  const LioConfig before = simulated_robot();
  const LioConfig after = change_live(before, "imu/k_gb", text("25"));
  EXPECT_EQ(after.imu.scale.k_gb, 25.0);
  EXPECT_EQ(live_difference(before, after), "imu/k_gb 1 -> 25");
  LioConfig undone = after;
  undone.imu.scale.k_gb = before.imu.scale.k_gb;
  EXPECT_EQ(print_config(undone), print_config(before));
  EXPECT_EQ(live_difference(before, before), "");
}

TEST(LiveParameters, what_is_not_live_unknown_or_out_of_range_is_refused_with_the_reason) {
  EXPECT_NE(refusal("map/voxel_size", "1").find("map/voxel_size"), std::string::npos);
  EXPECT_NE(refusal("map/voxel_size", "1").find("cannot be changed while the filter runs"), std::string::npos);
  EXPECT_NE(refusal("imu/k_gbb", "1").find("imu/k_gb"), std::string::npos) << refusal("imu/k_gbb", "1");
  for (const char* value : {"-1", "0", "nan", "inf", "much", ""}) {
    const std::string why = refusal("imu/k_gb", value);
    EXPECT_NE(why.find("imu/k_gb"), std::string::npos) << value;
    EXPECT_NE(why.find(value), std::string::npos) << why;
    EXPECT_NE(why.find("a test"), std::string::npos) << why;
  }
  EXPECT_NE(refusal("update/max_iterations", "51"), "");
  EXPECT_NE(refusal("update/max_iterations", "2.5"), "");
}

}  // namespace
}  // namespace allan_lio
