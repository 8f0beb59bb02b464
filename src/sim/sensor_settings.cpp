// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/sensor_settings.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "allan_lio/imu/physical_unit.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

/// Units that are common here and no part of a noise's.
PhysicalUnit unit_of(const std::string& text) {
  static const std::map<std::string, std::pair<double, const char*>> kShort = {
      {"mrad", {1e-3, "rad"}}, {"mm", {1e-3, "m"}}, {"cm", {1e-2, "m"}}, {"%", {1e-2, ""}}, {"ppm", {1e-6, ""}}};
  const auto found = kShort.find(text);
  if (text == "1") return {};
  if (found == kShort.end()) return parse_unit(text);
  const std::string base = found->second.second;
  PhysicalUnit unit = base.empty() ? PhysicalUnit() : parse_unit(base);
  unit.factor *= found->second.first;
  return unit;
}

/// "500ppm" to 5e-4 where "1" is wanted.
double parse_value(const std::string& text, const SensorSetting& setting) {
  const auto refuse = [&](const std::string& why) {
    return std::invalid_argument("'" + setting.key + "=" + text + "': " + why + "; write for example " + setting.key +
                                 "=" + setting.example);
  };
  double number = 0.0;
  std::size_t end = std::min(text.find_first_not_of("0123456789.+-eE"), text.size());
  while (end > 0 && !parse_number(text.substr(0, end), &number)) --end;
  if (end == 0) throw refuse("no number");
  const std::string unit_text = text.substr(end);
  if (unit_text.empty()) {
    if (number != 0 && setting.unit != "1") throw refuse("the unit is missing");
    return number;
  }
  PhysicalUnit unit;
  try {
    unit = unit_of(unit_text);
  } catch (const std::invalid_argument& error) {
    throw refuse(error.what());
  }
  if (unit.exponents != unit_of(setting.unit).exponents)
    throw refuse("'" + unit_text + "' is no unit of " + (setting.unit == "1" ? "a plain number" : setting.unit));
  return number * unit.factor;
}

std::string keys_of(const std::vector<SensorSetting>& settings) {
  std::string text;
  for (const SensorSetting& one : settings) text += (text.empty() ? "" : ", ") + one.key + "=" + one.example;
  return text;
}

/// `real` is what that word stands for.
template <typename Errors>
Errors parse(const std::vector<std::string>& words, const Errors& real, const char* what) {
  Errors errors;
  const std::vector<SensorSetting> settings = settings_of(errors);
  for (const std::string& word : words) {
    if (word == "real") {
      errors = real;
      continue;
    }
    const std::size_t equals = word.find('=');
    const std::string key = word.substr(0, equals);
    const auto found =
        std::find_if(settings.begin(), settings.end(), [&](const SensorSetting& one) { return one.key == key; });
    if (found == settings.end() || equals == std::string::npos)
      throw std::invalid_argument("'" + word + "' is no " + what + "; there are real, " + keys_of(settings));
    const double value = parse_value(word.substr(equals + 1), *found);
    for (double* target : found->targets) *target = value;
  }
  check(errors);
  return errors;
}

template <typename Errors>
std::string text_of(Errors errors) {
  std::string text;
  for (const SensorSetting& one : settings_of(errors)) {
    if (one.targets.size() > 1 || *one.targets[0] == 0) continue;
    text += (text.empty() ? "" : " ") + one.key + "=" + number_text(*one.targets[0]);
    if (one.unit != "1") text += one.unit;
  }
  return text.empty() ? "none" : text;
}

/// What a Velodyne of 16 or 32 lines does, roughly: divergence 3 mrad (manual: 3.0 by 1.2 mrad, quoted from memory)
/// and 2 mm steps (manual); shares and ranges are estimates.
LidarEffects real_lidar_effects() {
  LidarEffects effects;
  effects.divergence = 3e-3;
  effects.grazing = 0.25;
  effects.mixed_pixels = 0.5;
  effects.dropout_rate = 0.01;
  effects.dropout_range = 150.0;
  effects.intensity_range = 10.0;
  effects.quantization = 2e-3;
  return effects;
}

}  // namespace

std::vector<SensorSetting> settings_of(ImuDefects& d) {
  return {
      {"scale_factor", "1", {&d.gyro.scale_factor, &d.accel.scale_factor}, "500ppm"},
      {"gyro_scale_factor", "1", {&d.gyro.scale_factor}, "500ppm"},
      {"accel_scale_factor", "1", {&d.accel.scale_factor}, "500ppm"},
      {"misalignment", "rad", {&d.gyro.misalignment, &d.accel.misalignment}, "1mrad"},
      {"gyro_misalignment", "rad", {&d.gyro.misalignment}, "1mrad"},
      {"accel_misalignment", "rad", {&d.accel.misalignment}, "1mrad"},
      {"g_sensitivity", "rad/s/(m/s^2)", {&d.g_sensitivity}, "0.001deg/s/g"},
      {"gyro_vibration", "rad/s", {&d.gyro.vibration}, "0.1deg/s"},
      {"accel_vibration", "m/s^2", {&d.accel.vibration}, "0.05m/s^2"},
      {"vibration_frequency", "Hz", {&d.vibration_frequency}, "187Hz"},
      {"vibration_bandwidth", "Hz", {&d.vibration_bandwidth}, "2Hz"},
      {"rectification", "1/(m/s^2)", {&d.rectification}, "100ug/g^2"},
      {"gyro_quantization", "rad/s", {&d.gyro.quantization}, "0.06deg/s"},
      {"accel_quantization", "m/s^2", {&d.accel.quantization}, "0.3mg"},
      {"gyro_range", "rad/s", {&d.gyro.range}, "300deg/s"},
      {"accel_range", "m/s^2", {&d.accel.range}, "3g"},
      {"clock_offset", "s", {&d.clock_offset}, "2ms"},
      {"clock_drift", "1", {&d.clock_drift}, "10ppm"},
      {"stamp_jitter", "s", {&d.stamp_jitter}, "0.2ms"},
      {"dropped_samples", "1", {&d.dropped_samples}, "0.1%"},
  };
}

std::vector<SensorSetting> settings_of(LidarEffects& e) {
  return {
      {"divergence", "rad", {&e.divergence}, "3mrad"},    {"grazing", "1", {&e.grazing}, "0.25"},
      {"mixed_pixels", "1", {&e.mixed_pixels}, "50%"},    {"dropout_rate", "1", {&e.dropout_rate}, "1%"},
      {"dropout_range", "m", {&e.dropout_range}, "150m"}, {"intensity_range", "m", {&e.intensity_range}, "10m"},
      {"quantization", "m", {&e.quantization}, "2mm"},
  };
}

ImuDefects parse_imu_errors(const std::vector<std::string>& words) {
  return parse(words, mti600_defects(), "error of an IMU");
}

LidarEffects parse_lidar_effects(const std::vector<std::string>& words) {
  return parse(words, real_lidar_effects(), "effect of a LiDAR");
}

std::string settings_text(const ImuDefects& defects) {
  ImuDefects shown = defects;
  // The line's place is of no matter without a line.
  if (defects.gyro.vibration == 0 && defects.accel.vibration == 0)
    shown.vibration_frequency = shown.vibration_bandwidth = shown.rectification = 0.0;
  return text_of(shown);
}
std::string settings_text(const LidarEffects& effects) { return text_of(effects); }

std::string imu_error_keys() {
  ImuDefects defects;
  return keys_of(settings_of(defects));
}

std::string lidar_effect_keys() {
  LidarEffects effects;
  return keys_of(settings_of(effects));
}

}  // namespace allan_lio
