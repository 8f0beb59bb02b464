// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/sim/imu_defects.h"
#include "allan_lio/sim/lidar_effects.h"

namespace allan_lio {

/// A figure that can be set by name, in the SI unit (rad as angle).
struct SensorSetting {
  std::string key;
  std::string unit;              ///< SI; "1" for shares and factors
  std::vector<double*> targets;  ///< in the object that was asked
  std::string example;           ///< "500ppm"
};

/// The figures of each, by the names of the structs' fields; `scale_factor` and `misalignment` stand for gyro_ and
/// accel_ together. The pointers live as long as the object.
std::vector<SensorSetting> settings_of(ImuDefects& defects);
std::vector<SensorSetting> settings_of(LidarEffects& effects);

/// Reads words such as `real`, `scale_factor=500ppm`, `g_sensitivity=0.001deg/s/g` or `vibration=0`, the later ones
/// over the earlier ones. Units are those of physical_unit.h besides mrad, mm, cm, %, ppm; only 0 and numbers without
/// dimension may go without. Throws std::invalid_argument naming the word, and what there is, for anything else; the
/// result has passed check().
ImuDefects parse_imu_errors(const std::vector<std::string>& words);
LidarEffects parse_lidar_effects(const std::vector<std::string>& words);

/// `key=value` of what is in force, in SI, or "none".
std::string settings_text(const ImuDefects& defects);
std::string settings_text(const LidarEffects& effects);

/// All keys with an example each, for a help text.
std::string imu_error_keys();
std::string lidar_effect_keys();

}  // namespace allan_lio
