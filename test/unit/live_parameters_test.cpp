// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/live_parameters.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "allan_lio/io/known_keys.h"
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

TEST(LiveParameters, a_senseless_value_is_refused_with_its_reason) {
  ConfigEntry entry{{}, true, "a test"};
  entry.senseless = "no value at all";
  try {
    change_live(simulated_robot(), "imu/k_gb", entry);
    FAIL() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_STREQ(error.what(), "a test: no value at all");
  }
  EXPECT_THROW(change_live(simulated_robot(), "imu/k_gb", {{}, false, "a test"}), ConfigError) << "k_gb: {}";
}

TEST(LiveParameters, what_stays_is_said_with_its_value_whatever_the_key) {
  LioConfig config = simulated_robot();
  config.imu.scale.k_gb = 25.0;
  config.map.voxel_size = 0.75;
  config.T_imu_lidar.translation = {1.0, 2.0, 0.5};
  EXPECT_EQ(what_stays(config, "imu/k_gb"), "imu/k_gb stays 25");
  EXPECT_EQ(what_stays(config, "imu/k_gb/a"), "imu/k_gb stays 25");
  EXPECT_EQ(what_stays(config, "map/voxel_size"), "map/voxel_size stays 0.75");
  EXPECT_EQ(what_stays(config, "frames/odom"), "frames/odom stays \"odom\"");
  EXPECT_EQ(what_stays(config, "extrinsics/T_imu_lidar/translation"),
            "extrinsics/T_imu_lidar/translation stays [1, 2, 0.5]");
  const std::string quantity = what_stays(config, "imu/noise/gyro_white_noise/unit");
  EXPECT_EQ(quantity.find("imu/noise/gyro_white_noise stays {value: "), 0U) << quantity;
  EXPECT_EQ(what_stays(config, "imu/noise/gyro_bias_sigma/value"),
            "imu/noise/gyro_bias_sigma stays as it is, not given");
  for (const char* key : {"imu/k_gbb", "imu", "k_gb"}) EXPECT_EQ(what_stays(config, key), "all that is in force stays");
}

TEST(LiveParameters, a_parameter_is_found_at_its_key_and_at_those_below_it) {
  const LioConfig config = simulated_robot();
  EXPECT_EQ(parameter_at(config, "imu/noise/gyro_white_noise/value")->info.key, "imu/noise/gyro_white_noise");
  EXPECT_EQ(parameter_at(config, "imu/k_g")->info.key, "imu/k_g");
  for (const char* key : {"imu/k", "imu/k_gbb", "imu", ""}) EXPECT_FALSE(parameter_at(config, key)) << key;
}

TEST(LiveParameters, an_empty_group_says_nothing_and_an_empty_parameter_does) {
  const ConfigEntry empty{{}, false, "a test"};
  EXPECT_TRUE(is_empty_group("imu", empty));
  EXPECT_TRUE(is_empty_group("imu/noise", empty));
  for (const char* key : {"imu/k_gb", "imu/noise/gyro_white_noise", "imus"})
    EXPECT_FALSE(is_empty_group(key, empty)) << key;
  EXPECT_FALSE(is_empty_group("imu", text("1")));
}

TEST(LiveParameters, the_fixed_ones_are_all_the_others) {
  LioConfig config = simulated_robot();
  config.imu.scale.k_gb = 3.0;
  const ConfigSource fixed = fixed_parameters(config), all = to_source(config);
  EXPECT_EQ(fixed.size() + live_parameters(config).size(), all.size());
  // What ~state carries.
  for (const char* key :
       {"imu/k_g", "imu/k_a", "imu/k_gb", "imu/k_ab", "imu/gyro_range", "imu/accel_range", "imu/max_gap", "lidar/k_r"})
    EXPECT_EQ(fixed.count(key), 0U) << key;
  for (const char* key : {"imu/noise/gyro_white_noise/value", "frames/base", "realtime_priority", "imu/discretization"})
    EXPECT_EQ(fixed.at(key).items, all.at(key).items) << key;
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
