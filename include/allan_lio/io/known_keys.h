// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// Throws ConfigError for the first entry whose key no parameter has, naming the nearest one that exists. A group
/// ("imu/noise") may stand there without a value; a quantity's own key is let through, for the reader to say that a
/// unit is needed.
void refuse_unknown_keys(const ConfigSource& source);

/// True for a group without a value of its own, as "imu" in {imu: {}}: it says nothing.
bool is_empty_group(const std::string& key, const ConfigEntry& entry);

}  // namespace allan_lio
