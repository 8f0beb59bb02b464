// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/known_keys.h"
#include "allan_lio/io/noise_keys.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/parameter_list.h"

namespace allan_lio {
namespace {

std::string join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

[[noreturn]] void refuse(const std::string& key, const ConfigEntry& entry, const std::string& sentence) {
  const std::string value = entry.is_list ? "[" + join(entry.items) + "]" : "'" + join(entry.items) + "'";
  throw ConfigError(key + " = " + value + " (" + entry.origin + "): " + sentence);
}

/// Sets every declared field from the source, or to its default where the source is silent.
class Reader : public ParameterVisitor {
 public:
  explicit Reader(const ConfigSource& source) : source_(source) {}

  void number(const ParameterInfo& info, double& field, double fallback, const ParameterRange& range) override {
    const ConfigEntry* entry = find(info.key);
    field = entry ? to_number(info.key, *entry, scalar(info.key, *entry), range, info.unit) : fallback;
  }

  void integer(const ParameterInfo& info, int& field, int fallback, const ParameterRange& range) override {
    const ConfigEntry* entry = find(info.key);
    const double value = entry ? to_number(info.key, *entry, scalar(info.key, *entry), range, "") : fallback;
    if (value != std::floor(value) || std::abs(value) > 1e9) refuse(info.key, *entry, "must be a whole number");
    field = static_cast<int>(value);
  }

  void flag(const ParameterInfo& info, bool& field, bool fallback) override {
    const ConfigEntry* entry = find(info.key);
    field = entry ? to_flag(info.key, *entry) : fallback;
  }

  void text(const ParameterInfo& info, std::string& field, const std::string& fallback) override {
    const ConfigEntry* entry = find(info.key);
    field = entry ? scalar(info.key, *entry) : fallback;
  }

  void choice(const ParameterInfo& info, int& field, int fallback, const std::vector<std::string>& names) override {
    const ConfigEntry* entry = find(info.key);
    field = fallback;
    if (entry == nullptr) return;
    const auto at = std::find(names.begin(), names.end(), scalar(info.key, *entry));
    if (at == names.end()) refuse(info.key, *entry, "must be one of " + join(names));
    field = static_cast<int>(at - names.begin());
  }

  void numbers(const ParameterInfo& info, Eigen::Ref<Eigen::VectorXd> field, const Eigen::VectorXd& fallback,
               const ParameterRange& range) override {
    field = fallback;
    const ConfigEntry* entry = find(info.key);
    if (entry == nullptr) return;
    const std::size_t size = static_cast<std::size_t>(fallback.size());
    if (!entry->is_list || entry->items.size() != size)
      refuse(info.key, *entry, "must be a list of " + std::to_string(size) + " numbers");
    for (std::size_t i = 0; i < size; ++i)
      field[static_cast<Eigen::Index>(i)] = to_number(indexed(info.key, i), *entry, entry->items[i], range, info.unit);
  }

  void quantity(const ParameterInfo& info, Eigen::Vector3d& field, Dimension dimension,
                const ParameterRange& range) override {
    if (const ConfigEntry* bare = find(info.key)) refuse(info.key, *bare, "a unit is needed: " + wanted(dimension));
    const ConfigEntry* value = find(info.key + "/value");
    const ConfigEntry* unit = find(info.key + "/unit");
    const double rate = rate_of(info.key);
    if (value == nullptr) {
      throw ConfigError(info.key + " is missing" + (unit ? " its value (" + unit->origin + ")" : "") +
                        ": an IMU's noise has no default. Include the file of the IMU, for example " +
                        "'include: [imu/mti600]', or give " + wanted(dimension));
    }
    if (unit == nullptr) refuse(info.key + "/value", *value, "a unit is needed: " + wanted(dimension));
    const NoiseForm form = convert_noise_unit(scalar(info.key + "/unit", *unit), dimension);
    if (!form.ok()) refuse(info.key + "/unit", *unit, form.error);
    check_rate(info.key, *unit, dimension, rate);
    if (value->items.size() != (value->is_list ? 3u : 1u))
      refuse(info.key + "/value", *value, "must be one number, or a list of 3 for the axes x, y, z");
    for (std::size_t i = 0; i < 3; ++i) {
      const std::string key = value->is_list ? indexed(info.key + "/value", i) : info.key + "/value";
      // A range is positive or not negative, so it holds in any unit; what under- or overflows in SI is caught after.
      const double number = to_number(key, *value, value->items[value->is_list ? i : 0], range, "");
      const double si = form.apply(number, rate);
      if (!std::isfinite(si) || (si == 0.0) != (number == 0.0)) refuse(key, *value, "is beyond all measure");
      field[static_cast<Eigen::Index>(i)] = si;
    }
  }

  void optional_quantity(const ParameterInfo& info, Eigen::Vector3d& field, double absent, Dimension dimension,
                         const ParameterRange& range) override {
    field.setConstant(absent);
    const bool given = find(info.key) || find(info.key + "/value") || find(info.key + "/unit");
    if (given) quantity(info, field, dimension, range);
  }

 private:
  /// `rate: 400 Hz` of a quantity; 0 if there is none.
  double rate_of(const std::string& key) const {
    const ConfigEntry* entry = find(key + "/rate");
    if (entry == nullptr) return 0.0;
    const std::string& text = scalar(key + "/rate", *entry);
    const std::size_t end = text.find_first_not_of("0123456789+-.eE");
    double number = 0.0;
    if (end == std::string::npos || !parse_number(text.substr(0, end), &number))
      refuse(key + "/rate", *entry, "must be a number with its unit, for example '400 Hz'");
    const UnitConversion unit = convert_unit(text.substr(text.find_first_not_of(' ', end)), Dimension::kFrequency);
    if (!unit.ok()) refuse(key + "/rate", *entry, unit.error);
    if (!(number > 0)) refuse(key + "/rate", *entry, "must be > 0");
    return number * unit.to_si;
  }

  static void check_rate(const std::string& key, const ConfigEntry& unit, Dimension dimension, double rate) {
    const std::string& text = unit.items.front();
    const bool of_samples = convert_noise_unit(text, dimension).of_samples;
    if (of_samples && rate == 0.0) {
      refuse(key + "/unit", unit,
             convert_unit(text, dimension).error +
                 "; if it is a figure of single samples, add the rate at which they are taken: 'rate: 400 Hz'");
    }
    if (!of_samples && rate != 0.0)
      refuse(key + "/unit", unit, "is not the unit of a figure of single samples; the rate beside it has no meaning");
  }

  const ConfigEntry* find(const std::string& key) const {
    const auto at = source_.find(key);
    return at == source_.end() ? nullptr : &at->second;
  }

  static std::string indexed(const std::string& key, std::size_t i) { return key + "[" + std::to_string(i) + "]"; }

  static std::string wanted(Dimension dimension) {
    const std::vector<std::string> units = usual_units(dimension);
    return "{value: NUMBER, unit: UNIT}, the unit one of " + join(units);
  }

  static const std::string& scalar(const std::string& key, const ConfigEntry& entry) {
    if (entry.is_list) refuse(key, entry, "must be a single value, not a list");
    if (entry.items.size() != 1) refuse(key, entry, "has no value");
    return entry.items.front();
  }

  static double to_number(const std::string& key, const ConfigEntry& entry, const std::string& text,
                          const ParameterRange& range, const std::string& unit) {
    double value = 0.0;
    if (!parse_number(text, &value)) refuse(key, entry, "'" + text + "' is not a finite decimal number");
    const bool inside = value <= range.high && (range.exclusive_low ? value > range.low : value >= range.low);
    if (!inside) {
      refuse(key, entry,
             text + " is out of range: must be " + range_text(range) + (unit.empty() || unit == "1" ? "" : " " + unit));
    }
    return value;
  }

  /// YAML 1.1's words, since that is how the parameter server reads the same file.
  static bool to_flag(const std::string& key, const ConfigEntry& entry) {
    std::string word = scalar(key, entry);
    for (char& c : word) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (word == "true" || word == "yes" || word == "on") return true;
    if (word == "false" || word == "no" || word == "off") return false;
    refuse(key, entry, "must be true or false");
  }

  const ConfigSource& source_;
};

/// Leaves what is unit to rounding as it is, so that a printed configuration reads back to the same bits.
void normalise(Eigen::Quaterniond& rotation) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  if (std::abs(rotation.norm() - 1.0) > kRounding) rotation.normalize();
}

void check_rotation(const std::string& key, const Eigen::Quaterniond& rotation) {
  constexpr double kNormTolerance = 1e-3;
  const double norm = rotation.norm();
  if (std::abs(norm - 1.0) > kNormTolerance)
    throw ConfigError(key + " must be a unit quaternion x, y, z, w; its norm is " + number_text(norm));
}

/// check_config() sees only values; this adds where those that it names were set.
void check_with_origins(const LioConfig& config, const ConfigSource& source) {
  try {
    check_config(config);
  } catch (const ConfigError& error) {
    std::string sentence = error.what();
    for (const auto& item : source) {
      if (sentence.find(item.first + " ") != std::string::npos)
        sentence += " (" + item.first + ": " + item.second.origin + ")";
    }
    throw ConfigError(sentence);
  }
}

}  // namespace

LioConfig read_config(const ConfigSource& source) {
  for (const auto& item : source)
    if (!item.second.senseless.empty()) throw ConfigError(item.second.origin + ": " + item.second.senseless);
  refuse_unknown_keys(source);
  check_noise_keys(source);
  LioConfig config{};
  Reader reader(source);
  declare_parameters(reader, config);
  check_with_origins(config, source);
  normalise(config.T_imu_lidar.rotation);
  normalise(config.T_base_imu.rotation);
  return config;
}

LioConfig default_config(const NoiseSpec& spec) {
  /// The quantities alone have no default and keep what is there.
  class Defaults : public Reader {
   public:
    using Reader::Reader;
    void quantity(const ParameterInfo&, Eigen::Vector3d&, Dimension, const ParameterRange&) override {}
    void optional_quantity(const ParameterInfo&, Eigen::Vector3d&, double, Dimension, const ParameterRange&) override {}
  };
  const ConfigSource nothing;
  LioConfig config{};
  config.imu.spec = spec;
  Defaults defaults(nothing);
  declare_parameters(defaults, config);
  return config;
}

void check_config(const LioConfig& config) {
  const LioConfig::Lidar& lidar = config.lidar;
  if (lidar.min_range >= lidar.max_range) {
    throw ConfigError("lidar/min_range = " + number_text(lidar.min_range) +
                      " must be less than lidar/max_range = " + number_text(lidar.max_range));
  }
  if (lidar.max_registered > 0 && lidar.max_registered < lidar.min_points) {
    throw ConfigError("lidar/max_registered = " + std::to_string(lidar.max_registered) +
                      " must be 0 or at least lidar/min_points = " + std::to_string(lidar.min_points));
  }
  check_rotation("extrinsics/T_imu_lidar/rotation", config.T_imu_lidar.rotation);
  check_rotation("extrinsics/T_base_imu/rotation", config.T_base_imu.rotation);
  const NoiseSpec& spec = config.imu.spec;
  if (config.imu.bias_model == BiasModel::kGaussMarkov) {
    const char* const sensor = !spec.gyro.bias_time.allFinite()    ? "gyro"
                               : !spec.accel.bias_time.allFinite() ? "accel"
                                                                   : nullptr;
    if (sensor != nullptr) {
      throw ConfigError("imu/bias_model = gauss_markov needs imu/noise/" + std::string(sensor) +
                        "_bias_time : a random walk has no correlation time");
    }
  }
  const std::pair<const char*, const std::string*> names[] = {
      {"topics/imu", &config.topics.imu},   {"topics/lidar", &config.topics.lidar},
      {"frames/odom", &config.frames.odom}, {"frames/base", &config.frames.base},
      {"frames/imu", &config.frames.imu},   {"frames/lidar", &config.frames.lidar}};
  for (const auto& name : names) {
    if (name.second->empty()) throw ConfigError(std::string(name.first) + " must not be empty");
  }
  if (config.frames.odom == config.frames.base)
    throw ConfigError("frames/odom and frames/base must differ; both are '" + config.frames.odom + "'");
  const bool base_is_imu = config.T_base_imu.translation.isZero(0) && config.T_base_imu.rotation.vec().isZero(0);
  if (config.frames.base == config.frames.imu && !config.frames.extrinsics_from_tf && !base_is_imu)
    throw ConfigError("frames/base and frames/imu are both '" + config.frames.base +
                      "', so extrinsics/T_base_imu must be the identity");
}

}  // namespace allan_lio
