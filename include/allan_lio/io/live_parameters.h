// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {

/// The parameters that may be changed while the filter runs, with their values in `config`.
std::vector<ParameterEntry> live_parameters(const LioConfig& config);

/// to_source() without them.
ConfigSource fixed_parameters(const LioConfig& config);

/// The parameter that `key` is, or lies below ("imu/noise/gyro_white_noise" of its "/unit"); nothing if there is none.
std::optional<ParameterEntry> parameter_at(const LioConfig& config, const std::string& key);

/// "imu/k_gb stays 25": what is in force when a change of `key` is refused.
std::string what_stays(const LioConfig& in_force, const std::string& key);

/// `in_force` with one live parameter changed. Throws ConfigError for a key that is unknown or not live, and for a
/// value that read_config() refuses.
LioConfig change_live(const LioConfig& in_force, const std::string& key, const ConfigEntry& value);

/// "imu/k_gb 1 -> 25; lidar/k_r 1 -> 2": the live parameters in which the two differ; empty if none does.
std::string live_difference(const LioConfig& before, const LioConfig& after);

}  // namespace allan_lio
