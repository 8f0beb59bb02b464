// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/reconfigure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "allan_lio/io/live_parameters.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

std::map<std::string, double> numbers(const dynamic_reconfigure::Config& message) {
  std::map<std::string, double> values;
  for (const auto& item : message.doubles) values[item.name] = item.value;
  for (const auto& item : message.ints) values[item.name] = item.value;
  return values;
}

TEST(Reconfigure, describes_every_live_parameter_as_it_is_declared) {
  const LioConfig config = simulated_robot();
  const dynamic_reconfigure::ConfigDescription description = to_description(config);
  const std::vector<ParameterEntry> entries = live_parameters(config);
  const auto low = numbers(description.min), high = numbers(description.max);
  ASSERT_EQ(description.groups.size(), 1U);
  ASSERT_EQ(description.groups[0].parameters.size(), entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const auto& parameter = description.groups[0].parameters[i];
    EXPECT_EQ(parameter.name, entries[i].info.key);
    EXPECT_EQ(parameter.description.find(entries[i].info.sentence), 0U) << parameter.description;
    EXPECT_EQ(parameter.type, entries[i].kind == ParameterEntry::Kind::kInteger ? "int" : "double") << parameter.name;
    ASSERT_EQ(low.count(parameter.name), 1U) << parameter.name;
    if (std::isfinite(entries[i].range.low)) {
      EXPECT_EQ(low.at(parameter.name), entries[i].range.low);
    }
    if (std::isfinite(entries[i].range.high)) {
      EXPECT_EQ(high.at(parameter.name), entries[i].range.high);
    }
  }
}

TEST(Reconfigure, shows_values_in_force_and_defaults) {
  LioConfig config = simulated_robot();
  config.imu.scale.k_gb = 0.1 + 0.2;
  config.update.max_iterations = 9;
  EXPECT_EQ(numbers(to_config_message(config)).at("imu/k_gb"), 0.1 + 0.2);
  EXPECT_EQ(numbers(to_config_message(config)).at("update/max_iterations"), 9);
  EXPECT_EQ(numbers(to_description(config).dflt).at("imu/k_gb"), 1.0);
}

TEST(Reconfigure, a_request_that_repeats_what_is_in_force_changes_nothing) {
  LioConfig config = simulated_robot();
  config.imu.scale.k_gb = 1.0 / 3.0;
  LioConfig after = config;
  for (const auto& [key, entry] : to_entries(to_config_message(config))) after = change_live(after, key, entry);
  EXPECT_EQ(print_config(after), print_config(config));
}

}  // namespace
}  // namespace allan_lio
