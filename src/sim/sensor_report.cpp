// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/sensor_report.h"

#include "allan_lio/io/number_text.h"
#include "allan_lio/sim/sensor_settings.h"

namespace allan_lio {
namespace {

std::string line(const std::string& key, const std::string& value) { return "  " + key + ": " + value + "\n"; }

std::string map_text(const std::vector<SensorSetting>& settings) {
  std::string text;
  for (const SensorSetting& one : settings)
    if (one.targets.size() == 1)
      text += "    " + one.key + ": " + number_text(*one.targets[0]) +
              (one.unit == "1" ? "\n" : "  # [" + one.unit + "]\n");
  return text;
}

/// Rows one after the other.
std::string matrix_text(const Eigen::Matrix3d& matrix) {
  std::string text;
  for (int row = 0; row < 3; ++row) {
    text += row == 0 ? "[" : ", ";
    for (int column = 0; column < 3; ++column) text += (column == 0 ? "[" : ", ") + number_text(matrix(row, column));
    text += "]";
  }
  return text + "]";
}

const char* truth_word(bool value) { return value ? "true" : "false"; }

}  // namespace

std::string sensor_report(const LidarPattern& pattern, const std::string& recorded_imu, const ImuErrorConfig& errors,
                          double imu_rate, std::uint64_t seed) {
  LidarEffects effects = pattern.effects;
  ImuDefects defects = errors.defects;
  std::string text = "# What simulate_bag simulated: SI units and radians; 0 is off.\nlidar:\n";
  text += line("pattern", pattern.name) + line("max_range", number_text(pattern.max_range)) +
          line("range_noise", number_text(pattern.range_noise)) + "  effects:\n" + map_text(settings_of(effects));
  text += "imu:\n";
  if (!recorded_imu.empty()) return text + line("recorded", '"' + recorded_imu + '"');
  text += line("rate", number_text(imu_rate)) + line("seed", std::to_string(seed)) +
          line("white_noise", truth_word(errors.white)) + line("bias_walk", truth_word(errors.bias_walk)) +
          line("turn_on_bias", truth_word(errors.turn_on)) + "  errors:\n" + map_text(settings_of(defects));
  if (!defects.any()) return text;
  const ImuDefectModel model(defects, imu_rate, seed);
  text += "  drawn:  # gyro = (I + gyro_error) rate + g_sensitivity force; accel = (I + accel_error) force\n";
  return text + "  " + line("gyro_error", matrix_text(model.gyro_error())) + "  " +
         line("accel_error", matrix_text(model.accel_error())) + "  " +
         line("g_sensitivity", matrix_text(model.g_sensitivity()));
}

}  // namespace allan_lio
