// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/noise_keys.h"

namespace allan_lio {
namespace {

const char* const kSensors[] = {"imu/noise/gyro_", "imu/noise/accel_"};
const char* const kFigures[] = {"bias_instability", "bias_random_walk", "bias_sigma"};
const char* const kTimes[] = {"bias_time", "bias_flat_time"};
const char* const kParts[] = {"", "/value", "/unit", "/rate"};

/// The entry of a quantity, whichever of its parts is there; null if none is.
const ConfigEntry* find_quantity(const ConfigSource& source, const std::string& key) {
  for (const char* part : kParts) {
    const auto at = source.find(key + part);
    if (at != source.end()) return &at->second;
  }
  return nullptr;
}

void erase_quantity(ConfigSource& source, const std::string& key) {
  for (const char* part : kParts) source.erase(key + part);
}

/// The one of `names` that is given, or empty. Throws ConfigError if two are.
template <std::size_t kCount>
std::string the_one(const ConfigSource& source, const std::string& sensor, const char* const (&names)[kCount]) {
  std::string found;
  for (const char* name : names) {
    const ConfigEntry* entry = find_quantity(source, sensor + name);
    if (entry == nullptr) continue;
    if (!found.empty()) {
      throw ConfigError(sensor + found + " (" + find_quantity(source, sensor + found)->origin + ") and " + sensor +
                        name + " (" + entry->origin + ") say the same thing in two ways: give one of them");
    }
    found = name;
  }
  return found;
}

/// `over` says one of `names`: the others leave `base`.
template <std::size_t kCount>
bool drop_others(ConfigSource& base, const ConfigSource& over, const std::string& sensor,
                 const char* const (&names)[kCount]) {
  bool dropped = false;
  for (const char* said : names) {
    if (find_quantity(over, sensor + said) == nullptr) continue;
    for (const char* other : names) {
      if (other == said || find_quantity(base, sensor + other) == nullptr) continue;
      erase_quantity(base, sensor + other);
      dropped = true;
    }
  }
  return dropped;
}

}  // namespace

void check_noise_keys(const ConfigSource& source) {
  for (const std::string sensor : kSensors) {
    const std::string figure = the_one(source, sensor, kFigures), time = the_one(source, sensor, kTimes);
    if (figure.empty()) {
      throw ConfigError(sensor +
                        "bias_instability is missing: an IMU's noise has no default. Include the file of the "
                        "IMU, for example 'include: [imu/mti600]', or give it with " +
                        sensor + "bias_time; or " + sensor + "bias_random_walk; or " + sensor + "bias_sigma with " +
                        sensor + "bias_time");
    }
    if (time.empty() && figure != "bias_random_walk") {
      throw ConfigError(sensor + "bias_time is missing: " + sensor + figure + " (" +
                        find_quantity(source, sensor + figure)->origin + ") needs it, or " + sensor +
                        "bias_flat_time; or include the file of the IMU, for example 'include: [imu/mti600]'");
    }
  }
}

void drop_replaced_noise(ConfigSource& base, const ConfigSource& over) {
  for (const std::string sensor : kSensors) {
    if (drop_others(base, over, sensor, kFigures)) {
      for (const char* time : kTimes) erase_quantity(base, sensor + time);
    }
    drop_others(base, over, sensor, kTimes);
  }
  const std::string unit = "/unit";
  for (const auto& item : over) {
    const std::string& key = item.first;
    if (key.size() > unit.size() && key.compare(key.size() - unit.size(), unit.size(), unit) == 0)
      base.erase(key.substr(0, key.size() - unit.size()) + "/rate");
  }
}

}  // namespace allan_lio
