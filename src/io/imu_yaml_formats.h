// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/imu_yaml.h"

namespace allan_lio {

/// One figure of a format. The key is the last part of the path: packages and their forks nest it differently.
struct FigureRule {
  std::string key;
  bool gyro;
  FigureKind kind;
  std::string unit;  ///< of the number in the file
};

/// The four figures in the order of NoiseFile::figures. None for kAllanLio, whose file names its units itself.
std::vector<FigureRule> figure_rules(NoiseFormat format);

/// Where the file says at which rate samples are taken; empty if it does not. Point-LIO gives the period.
std::string rate_key(NoiseFormat format);

/// Whether the path ends with the key, as a whole part.
bool ends_with_key(const std::string& path, const std::string& key);

/// detect_noise_format() of a text that is parsed already.
NoiseFormat detect_noise_format(const ConfigSource& source, const std::string& text, const std::string& name);

}  // namespace allan_lio
