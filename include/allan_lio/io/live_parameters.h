// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {

/// The parameters that may be changed while the filter runs, with their values in `config`.
std::vector<ParameterEntry> live_parameters(const LioConfig& config);

/// `in_force` with one live parameter changed. Throws ConfigError for a key that is unknown or not live, and for a
/// value that read_config() refuses.
LioConfig change_live(const LioConfig& in_force, const std::string& key, const ConfigEntry& value);

/// "imu/k_gb 1 -> 25; lidar/k_r 1 -> 2": the live parameters in which the two differ; empty if none does.
std::string live_difference(const LioConfig& before, const LioConfig& after);

}  // namespace allan_lio
