// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "allan_lio/lio/lio_config.h"

namespace allan_lio {

/// A configuration that cannot be used. what() names the key, the value, its origin and what is accepted.
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One value as text, exactly as a YAML scalar would hold it; lists hold several.
struct ConfigEntry {
  std::vector<std::string> items;  ///< exactly one unless it is a list; none: the key stands there without a value
  bool is_list = false;
  std::string origin;          ///< "lio.yaml:12", "rosparam /lio/imu/k_gb", "--param"
  std::string senseless = {};  ///< why what stands there can be no value of any parameter; empty if it can
};

/// Flat view of a configuration: "imu/noise/gyro_white_noise/value" and so on, whatever it was read from.
using ConfigSource = std::map<std::string, ConfigEntry>;

/// Reads and checks every declared parameter. Throws ConfigError for an unknown key (naming the nearest known
/// one), a missing quantity, a value that is not of its type, NaN, inf or out of range, an unknown unit, for a
/// senseless entry, and for what check_config() refuses. A rotation that is unit to 1e-3 is normalised.
LioConfig read_config(const ConfigSource& source);

/// The defaults with an IMU noise of one's own, which has none.
LioConfig default_config(const NoiseSpec& spec);

/// Checks what one value cannot tell: min_range < max_range, a unit quaternion, frames and topics with names.
/// Throws ConfigError.
void check_config(const LioConfig& config);

/// Entries of `over` replace those of `base`.
ConfigSource merge(ConfigSource base, const ConfigSource& over);

/// Parses "key=value", the value as YAML: a list as [a, b, c], a quantity as {value: 0.42, unit: deg/sqrt(h)}.
/// Throws ConfigError.
ConfigSource parse_override(const std::string& text);

/// All parameters in force as YAML that read_config() takes back to the same LioConfig, bit for bit.
std::string print_config(const LioConfig& config);

/// The same, one entry a parameter.
ConfigSource to_source(const LioConfig& config);

/// 16 hexadecimal digits of print_config()'s FNV-1a hash.
std::string config_hash(const LioConfig& config);

}  // namespace allan_lio
