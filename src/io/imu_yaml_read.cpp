// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "allan_lio/imu/physical_unit.h"
#include "allan_lio/io/imu_yaml.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/io/yaml_source.h"
#include "imu_yaml_formats.h"

namespace allan_lio {
namespace {

using Found = const ConfigSource::value_type*;  ///< path and entry, null if there is none

/// Access to the entries of a file with errors that name it.
class Reader {
 public:
  Reader(const ConfigSource& source, std::string name, NoiseFormat format)
      : source_(source), name_(std::move(name)), format_(noise_format_name(format)) {}

  /// The one path that ends with the key.
  Found find(const std::string& key) const {
    Found found = nullptr;
    for (const auto& item : source_) {
      if (!ends_with_key(item.first, key)) continue;
      if (found != nullptr) {
        throw ConfigError(item.second.origin + ": " + item.first + " says again what " + found->first + " (" +
                          found->second.origin + ") says: give a file of one IMU");
      }
      found = &item;
    }
    return found;
  }

  Found need(const std::string& key) const {
    const Found found = find(key);
    if (found == nullptr) throw ConfigError(name_ + ": '" + key + "' is missing, which a " + format_ + " file has");
    return found;
  }

  double number(Found at) const {
    if (at->second.is_list) refuse(at, "must be one number, not a list");
    if (at->second.items.empty()) refuse(at, "has no value");
    return parse(at, at->second.items.front());
  }

  double positive(Found at) const {
    const double value = number(at);
    if (value == 0.0) refuse(at, "must be > 0");
    return value;
  }

  Eigen::Vector3d three(Found at) const {
    if (!at->second.is_list || at->second.items.size() != 3) refuse(at, "must be a list of 3 numbers");
    Eigen::Vector3d values;
    for (std::size_t i = 0; i < 3; ++i) values[static_cast<Eigen::Index>(i)] = parse(at, at->second.items[i]);
    return values;
  }

  [[noreturn]] static void refuse(Found at, const std::string& sentence) {
    throw ConfigError(at->second.origin + ": " + at->first + " " + sentence);
  }

 private:
  static double parse(Found at, const std::string& text) {
    double value = 0.0;
    if (!parse_number(text, &value)) refuse(at, "= '" + text + "' is not a finite decimal number");
    if (value < 0.0) refuse(at, "= " + text + " must not be negative");
    return value;
  }

  const ConfigSource& source_;
  std::string name_;
  std::string format_;
};

NoiseFigure make_figure(const FigureRule& rule, Found at, const Eigen::Vector3d& value) {
  NoiseFigure figure;
  figure.key = at->first;
  figure.origin = at->second.origin;
  figure.gyro = rule.gyro;
  figure.kind = rule.kind;
  figure.unit = rule.unit;
  figure.value = value;
  return figure;
}

/// The text at Gyr/unit and Acc/unit: upstream writes " rad/s" and " m/s^2" for both figures, the fork
/// "gyr_n: rad / sqrt(s), gyr_w: rad / s^2 / sqrt(Hz)".
bool tells_densities(Found unit) {
  if (unit->second.items.size() != 1) Reader::refuse(unit, "must be a text");
  std::string text;
  for (const char c : unit->second.items.front())
    if (c != ' ') text += c;
  if (text == "rad/s" || text == "m/s^2") return false;
  if (text == "gyr_n:rad/sqrt(s),gyr_w:rad/s^2/sqrt(Hz)" || text == "acc_n:m/s^2/sqrt(Hz),acc_w:m/s^3/sqrt(Hz)")
    return true;
  Reader::refuse(unit, "= '" + unit->second.items.front() +
                           "' is neither upstream imu_utils' ('rad/s', 'm/s^2') nor the mintar fork's "
                           "('gyr_n: rad / sqrt(s), gyr_w: rad / s^2 / sqrt(Hz)')");
}

/// The three axes, or the average where the axes were cut out of the file.
NoiseFigure imu_utils_figure(const Reader& reader, const FigureRule& rule) {
  const std::string sensor = rule.gyro ? "Gyr/" : "Acc/";
  const Found x = reader.find(sensor + "x-axis/" + rule.key);
  if (x == nullptr) {
    const Found average = reader.need(sensor + "avg-axis/" + rule.key);
    return make_figure(rule, average, Eigen::Vector3d::Constant(reader.number(average)));
  }
  const Found y = reader.need(sensor + "y-axis/" + rule.key), z = reader.need(sensor + "z-axis/" + rule.key);
  return make_figure(rule, x, Eigen::Vector3d(reader.number(x), reader.number(y), reader.number(z)));
}

NoiseFormat which_imu_utils(const Reader& reader) {
  const Found gyro = reader.need("Gyr/unit"), accel = reader.need("Acc/unit");
  const bool densities = tells_densities(gyro);
  if (tells_densities(accel) != densities)
    Reader::refuse(accel, "does not belong to the same version of imu_utils as " + gyro->first);
  return densities ? NoiseFormat::kImuUtilsMintar : NoiseFormat::kImuUtils;
}

/// With `use_imu_as_input: true` Point-LIO propagates with the samples, and the noise stands at other keys.
std::string point_lio_key(const Reader& reader, const FigureRule& rule) {
  const Found at = reader.find("use_imu_as_input");
  const bool input = at != nullptr && at->second.items == std::vector<std::string>{"true"};
  if (!input || !is_white(rule.kind)) return rule.key;
  return rule.gyro ? "gyr_cov_input" : "acc_cov_input";
}

std::vector<NoiseFigure> read_figures(const Reader& reader, NoiseFormat format) {
  std::vector<NoiseFigure> figures;
  for (const FigureRule& rule : figure_rules(format)) {
    if (format == NoiseFormat::kImuUtils || format == NoiseFormat::kImuUtilsMintar) {
      figures.push_back(imu_utils_figure(reader, rule));
      continue;
    }
    const Found at = reader.need(format == NoiseFormat::kPointLio ? point_lio_key(reader, rule) : rule.key);
    figures.push_back(make_figure(
        rule, at,
        format == NoiseFormat::kKfGins ? reader.three(at) : Eigen::Vector3d::Constant(reader.number(at)).eval()));
  }
  return figures;
}

/// The rate that was asked for, else the file's own.
double find_rate(const Reader& reader, NoiseFormat format, double asked, std::vector<std::string>& notes) {
  const std::string key = rate_key(format);
  const Found at = key.empty() ? nullptr : reader.find(key);
  if (at == nullptr) return asked;
  const double value = reader.positive(at), own = format == NoiseFormat::kPointLio ? 1.0 / value : value;
  if (asked <= 0.0) return own;
  if (std::abs(own / asked - 1.0) > 1e-6) {
    notes.push_back(at->second.origin + ": " + at->first + " tells a rate of " + number_text(own) + " Hz; " +
                    number_text(asked) + " Hz is used, as asked");
  }
  return asked;
}

void put_figure(const NoiseFigure& figure, double rate, SensorNoise& sensor) {
  const Eigen::Array3d si = parse_unit(figure.unit).factor * figure.value.array();
  switch (figure.kind) {
    case FigureKind::kDensity:
      sensor.white = si;
      return;
    case FigureKind::kSampleSigma:
      sensor.white = si / std::sqrt(rate);
      return;
    case FigureKind::kSampleVariance:
      sensor.white = (si / rate).sqrt();
      return;
    case FigureKind::kBiasInstability:
      sensor.bias_instability = si;
      return;
    case FigureKind::kRandomWalk:
      sensor.bias_random_walk = si;
      return;
    case FigureKind::kBiasVariance:
      sensor.bias_random_walk = (si / rate).sqrt();
      return;
    case FigureKind::kBiasSigma:
      sensor.bias_sigma = si;
      return;
  }
}

void add_notes(NoiseFile& file) {
  if (file.format == NoiseFormat::kAllanVarianceRos)
    file.notes.push_back("allan_variance_ros writes the worst of the three axes");
  if (file.format == NoiseFormat::kImuUtils) {
    file.notes.push_back(
        "upstream imu_utils: gyr_n and acc_n are taken as standard deviations of single samples, gyr_w and acc_w as "
        "the "
        "minimum of the Allan deviation, for which the file holds no correlation time");
  }
  if (file.format == NoiseFormat::kPointLio)
    file.notes.push_back(
        "Point-LIO's gyr_cov_output, acc_cov_output and vel_cov are the vehicle's motion, not the IMU");
}

}  // namespace

NoiseFile read_noise_file(const std::string& text, const std::string& name, NoiseFormat format, double rate) {
  if (format == NoiseFormat::kAllanLio) {
    NoiseFile file = read_noise_config(parse_yaml(text, name), name);
    file.rate = rate;
    return file;
  }
  const ConfigSource source = parse_foreign_yaml(text, name);
  const Reader reader(source, name, format);
  NoiseFile file;
  const bool imu_utils = format == NoiseFormat::kImuUtils || format == NoiseFormat::kImuUtilsMintar;
  file.format = imu_utils ? which_imu_utils(reader) : format;
  file.figures = read_figures(reader, file.format);
  file.rate = find_rate(reader, file.format, rate, file.notes);
  for (const NoiseFigure& figure : file.figures) {
    if (is_discrete(figure.kind) && !(file.rate > 0.0)) {
      throw ConfigError(figure.origin + ": " + figure.key +
                        " is a figure of single samples, which says nothing without the IMU's rate: give --rate");
    }
    put_figure(figure, file.rate, figure.gyro ? file.spec.gyro : file.spec.accel);
  }
  if (file.format == NoiseFormat::kKfGins) {
    const double hours = reader.positive(reader.need("corrtime"));
    file.spec.gyro.bias_time.setConstant(3600.0 * hours);
    file.spec.accel.bias_time.setConstant(3600.0 * hours);
  }
  add_notes(file);
  return file;
}

}  // namespace allan_lio
