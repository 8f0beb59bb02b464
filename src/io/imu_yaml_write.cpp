// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "allan_lio/imu/physical_unit.h"
#include "allan_lio/io/imu_yaml.h"
#include "allan_lio/io/number_text.h"
#include "imu_yaml_formats.h"

namespace allan_lio {
namespace {

constexpr double kSameAxes = 1e-9;  // relative: more is rounding no longer

bool same_axes(const Eigen::Vector3d& v) { return v.maxCoeff() - v.minCoeff() <= kSameAxes * v.maxCoeff(); }

/// "0.1", or "[0.1, 0.1, 0.2]".
std::string one_or_three(const Eigen::Vector3d& v, bool always_three = false) {
  if (!always_three && v.x() == v.y() && v.y() == v.z()) return number_text(v.x());
  return "[" + number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z()) + "]";
}

const char* sensor_name(bool gyro) { return gyro ? "gyro" : "accelerometer"; }

/// The figures of one noise in the form that a format wants.
class Writer {
 public:
  Writer(const NoiseSpec& spec, NoiseFormat format, const WriteOptions& options, std::vector<std::string>& notes)
      : spec_(spec), format_(format), options_(options), notes_(notes) {
    check(spec_.gyro, true);
    check(spec_.accel, false);
  }

  std::string text() {
    switch (format_) {
      case NoiseFormat::kAllanLio:
        return allan_lio();
      case NoiseFormat::kKalibr:
        return kalibr(false);
      case NoiseFormat::kAllanVarianceRos:
        return kalibr(true);
      case NoiseFormat::kImuUtils:
      case NoiseFormat::kImuUtilsMintar:
        return imu_utils();
      case NoiseFormat::kFastLio:
        return head("covariances of single samples at " + hertz() + ": they hold for that rate only") + "mapping:\n" +
               four_lines("    ");
      case NoiseFormat::kPointLio:
        return point_lio();
      case NoiseFormat::kLioSam:
        return head("densities and random walks") + "lio_sam:\n" + four_lines("  ");
      case NoiseFormat::kOpenVins:
        return openvins();
      case NoiseFormat::kKfGins:
        return kf_gins();
    }
    throw ConfigError("write_noise: unknown format");
  }

 private:
  /// A T_b from the options where the sensor needs one and has none; then everything must be finite and > 0.
  void check(SensorNoise& sensor, bool gyro) const {
    for (int axis = 0; axis < 3; ++axis) {
      double& time = sensor.bias_time[axis];
      if (!std::isfinite(time) && bias_kind(sensor) != BiasKind::kRandomWalk && options_.bias_time > 0.0)
        time = options_.bias_time;
    }
    const std::string name = sensor_name(gyro);
    if (!(sensor.white.allFinite() && sensor.white.minCoeff() > 0.0))
      throw ConfigError("the " + name + "'s white noise is zero or no number: there is nothing to convert");
    const bool told = sensor.bias_instability.maxCoeff() > 0.0 || sensor.bias_sigma.maxCoeff() > 0.0;
    if (told && !sensor.bias_time.allFinite()) {
      throw ConfigError("the " + name +
                        "'s bias is told by a level without a correlation time: give --bias-time (the "
                        "averaging time at which the Allan deviation is flat, over 1.8926)");
    }
    const Eigen::Vector3d density = bias_psd(sensor);
    if (!(density.allFinite() && density.minCoeff() > 0.0))
      throw ConfigError("the " + name + "'s bias noise is zero or no number: there is nothing to convert");
  }

  static std::string head(const std::string& what) { return "# IMU noise written by imu_noise: " + what + ".\n"; }

  double rate() const {
    if (!(options_.rate > 0.0))
      throw ConfigError("a " + noise_format_name(format_) + " file needs the IMU's rate: give --rate");
    return options_.rate;
  }

  std::string hertz() const { return number_text(rate()) + " Hz"; }

  const SensorNoise& sensor(bool gyro) const { return gyro ? spec_.gyro : spec_.accel; }

  /// The axes averaged in S.
  SensorNoise mean(bool gyro) {
    const SensorNoise& own = sensor(gyro);
    const Eigen::Vector3d density = bias_psd(own);
    if (!same_axes(own.white) || !same_axes(density)) {
      notes_.push_back(std::string("the ") + sensor_name(gyro) + "'s axes differ, " + noise_format_name(format_) +
                       " has one figure for the three: it is their root mean square");
    }
    if (own.bias_time.allFinite()) {
      notes_.push_back(std::string("the correlation time of the ") + sensor_name(gyro) +
                       "'s bias is lost: " + noise_format_name(format_) + " knows a random walk of the same S_b only");
    }
    SensorNoise result;
    result.white.setConstant(std::sqrt(own.white.squaredNorm() / 3.0));
    result.bias_random_walk.setConstant(std::sqrt(density.mean()));
    return result;
  }

  /// A figure as the format counts it, of a sensor whose bias is of that kind.
  Eigen::Vector3d figure(const FigureRule& rule, const SensorNoise& sensor) const {
    return si_figure(rule, sensor) / parse_unit(rule.unit).factor;
  }

  Eigen::Vector3d si_figure(const FigureRule& rule, const SensorNoise& sensor) const {
    switch (rule.kind) {
      case FigureKind::kDensity:
        return sensor.white;
      case FigureKind::kSampleSigma:
        return sensor.white * std::sqrt(rate());
      case FigureKind::kSampleVariance:
        return to_discrete(sensor, rate()).white;
      case FigureKind::kBiasInstability:
        return sensor.bias_instability;
      case FigureKind::kRandomWalk:
        return sensor.bias_random_walk;
      case FigureKind::kBiasVariance:
        return to_discrete(sensor, rate()).bias;
      case FigureKind::kBiasSigma:
        return sensor.bias_sigma;
    }
    throw ConfigError("write_noise: unknown kind of figure");
  }

  /// "key: value" of the formats that have one figure for the three axes.
  std::string four_lines(const std::string& indent) {
    const SensorNoise gyro = mean(true), accel = mean(false);
    std::string lines;
    for (const FigureRule& rule : figure_rules(format_))
      lines += indent + rule.key + ": " + number_text(figure(rule, rule.gyro ? gyro : accel).x()) + "  # [" +
               rule.unit + "]\n";
    return lines;
  }

  std::string allan_lio() {
    std::string text = head("S_b, N and T_b as its source told them") + "imu:\n  noise:\n";
    for (const bool gyro : {true, false}) {
      const std::string key = gyro ? "gyro" : "accel", u = gyro ? "rad/s" : "m/s^2", w = gyro ? "rad/s^2" : "m/s^3";
      const SensorNoise& own = sensor(gyro);
      const auto line = [&](const std::string& name, const Eigen::Vector3d& value, const std::string& unit) {
        text += "    " + key + "_" + name + ": {value: " + one_or_three(value) + ", unit: " + unit + "}";
      };
      line("white_noise", own.white, u + "/sqrt(Hz)");
      text += "\n";
      const BiasKind kind = bias_kind(own);
      if (kind == BiasKind::kRandomWalk) {
        line("bias_random_walk", own.bias_random_walk, w + "/sqrt(Hz)");
      } else {
        const bool allan = kind == BiasKind::kAllan;
        line(allan ? "bias_instability" : "bias_sigma", allan ? own.bias_instability : own.bias_sigma, u);
        text += "\n";
        line("bias_time", own.bias_time, "s");
      }
      text += "\n";
      turn_on_bias(gyro, line, text);
    }
    return text;
  }

  /// The other packages' files do not tell it.
  template <class Line>
  void turn_on_bias(bool gyro, const Line& line, std::string& text) {
    const Eigen::Vector3d& known = sensor(gyro).turn_on_bias;
    if (known.maxCoeff() > 0.0) {
      line("turn_on_bias", known, gyro ? "rad/s" : "m/s^2");
      text += "\n";
      return;
    }
    const char* const estimate = gyro ? "{value: 0.5, unit: deg/s}" : "{value: 20, unit: mg}";
    text += std::string("    ") + (gyro ? "gyro" : "accel") + "_turn_on_bias: " + estimate +
            "  # [est.] of a MEMS unit, not in the source: replace it by your data sheet's\n";
    notes_.push_back(std::string(gyro ? "gyro" : "accel") + "_turn_on_bias " + estimate +
                     " is an estimate for a MEMS unit: the source does not tell it, replace it");
  }

  std::string kalibr(bool allan_variance_ros) {
    const std::string hz = number_text(rate()), lines = four_lines("");
    std::string text = head("densities and random walks");
    if (allan_variance_ros) text += "#Accelerometer\n#Gyroscope\n";
    text += lines + "rostopic: /imu0  # not told by the source\nupdate_rate: " + hz + "  # [Hz]\n";
    notes_.push_back("rostopic: /imu0 is a placeholder");
    return text;
  }

  /// `what` of the three axes and of their average, as imu_utils lays it out.
  static std::string axes(const std::string& white_key, const Eigen::Vector3d& white, const std::string& bias_key,
                          const Eigen::Vector3d& bias) {
    std::string text;
    const auto one = [&](const char* name, double n, double w) {
      text += std::string("   ") + name + "-axis:\n      " + white_key + ": " + number_text(n) + "\n      " + bias_key +
              ": " + number_text(w) + "\n";
    };
    one("avg", white.mean(), bias.mean());
    one("x", white.x(), bias.x());
    one("y", white.y(), bias.y());
    one("z", white.z(), bias.z());
    return text;
  }

  std::string imu_utils() {
    const bool mintar = format_ == NoiseFormat::kImuUtilsMintar;
    const std::vector<FigureRule> rules = figure_rules(format_);
    std::string text = "%YAML:1.0\n---\n";
    text += head(mintar ? "N and K, as the fork by mintar has them"
                        : "sample deviations at " + hertz() + ", and the minimum of the Allan deviation");
    text += "type: IMU\nname: imu\n";
    for (const bool gyro : {true, false}) {
      const SensorNoise told = convert(gyro, mintar ? BiasKind::kRandomWalk : BiasKind::kAllan);
      const FigureRule &white = rules[gyro ? 0 : 1], &bias = rules[gyro ? 2 : 3];
      const std::string upstream = gyro ? " rad/s" : " m/s^2";
      const std::string fork = gyro ? "gyr_n: rad / sqrt(s), gyr_w: rad / s^2 / sqrt(Hz)"
                                    : "acc_n: m / s^2 / sqrt(Hz), acc_w: m / s^3 / sqrt(Hz)";
      text += std::string(gyro ? "Gyr" : "Acc") + ":\n   unit: \"" + (mintar ? fork : upstream) + "\"\n" +
              axes(white.key, figure(white, told), bias.key, figure(bias, told));
    }
    notes_.push_back("imu_utils' files hold no correlation time of the bias");
    return text;
  }

  /// convert_bias() that says what to give.
  SensorNoise convert(bool gyro, BiasKind kind) const {
    const SensorNoise& own = sensor(gyro);
    if (kind != BiasKind::kRandomWalk && !own.bias_time.allFinite() && !(options_.bias_time > 0.0)) {
      throw ConfigError("a " + noise_format_name(format_) + " file needs a correlation time of the bias, and the " +
                        sensor_name(gyro) + "'s is a random walk, which has none: give --bias-time");
    }
    return convert_bias(own, kind, options_.bias_time);
  }

  std::string point_lio() {
    std::string text = head("covariances of single samples at " + hertz() + ": they hold for that rate only") +
                       "mapping:\n    imu_time_inte: " + number_text(1.0 / rate()) + "  # [s]\n" + four_lines("    ");
    notes_.push_back(
        "for use_imu_as_input: true copy imu_meas_omg_cov and imu_meas_acc_cov to gyr_cov_input and "
        "acc_cov_input");
    return text;
  }

  std::string openvins() {
    const auto matrix = [](const std::string& name, int size, bool identity) {
      std::string text = "  " + name + ":\n";
      for (int row = 0; row < size; ++row) {
        text += "    - [";
        for (int column = 0; column < size; ++column)
          text += std::string(column > 0 ? ", " : "") + (identity && row == column ? "1.0" : "0.0");
        text += "]\n";
      }
      return text;
    };
    const std::string hz = number_text(rate());
    notes_.push_back("the matrices, rostopic and time_offset are placeholders: put your calibration's");
    return "%YAML:1.0\n\n" + head("densities and random walks") + "imu0:\n" + matrix("T_i_b", 4, true) +
           four_lines("  ") + "  rostopic: /imu0\n  time_offset: 0.0\n  update_rate: " + hz +
           "\n  model: \"kalibr\"\n" + matrix("Tw", 3, true) + matrix("R_IMUtoGYRO", 3, true) + matrix("Ta", 3, true) +
           matrix("R_IMUtoACC", 3, true) + matrix("Tg", 3, false);
  }

  /// It has one correlation time for all: the one that was asked for, else the noise's, else the mean of what differs.
  double common_bias_time() {
    if (options_.bias_time > 0.0) return options_.bias_time;
    Eigen::Matrix<double, 6, 1> times;
    times << spec_.gyro.bias_time, spec_.accel.bias_time;
    if (!times.allFinite()) {
      throw ConfigError(
          "a kf_gins file needs a correlation time of the bias, and a random walk has none: give "
          "--bias-time");
    }
    if (times.minCoeff() == times.maxCoeff()) return times[0];
    notes_.push_back("the correlation times differ, kf_gins has one corrtime: it is their mean; S_b is kept");
    return times.mean();
  }

  std::string kf_gins() {
    const double time = common_bias_time();
    std::string text = head("white noise and Gauss-Markov biases");
    if (options_.rate > 0.0) text += "imudatarate: " + number_text(options_.rate) + "  # [Hz]\n";
    text += "imunoise:\n";
    for (const FigureRule& rule : figure_rules(format_)) {
      SensorNoise told;
      told.white = sensor(rule.gyro).white;
      told.bias_sigma = (0.5 * time * bias_psd(sensor(rule.gyro))).cwiseSqrt();
      text += "  " + rule.key + ": " + one_or_three(figure(rule, told), true) + "  # [" + rule.unit + "]\n";
    }
    text +=
        "  gsstd: [0, 0, 0]  # [ppm] scale factors are not told by the source: 0 leaves them out\n"
        "  asstd: [0, 0, 0]  # [ppm]\n  corrtime: " +
        number_text(time / 3600.0) + "  # [h]\n";
    notes_.push_back("gsstd and asstd (scale factors) are 0: the source does not tell them");
    return text;
  }

  NoiseSpec spec_;
  NoiseFormat format_;
  WriteOptions options_;
  std::vector<std::string>& notes_;
};

}  // namespace

std::string write_noise(const NoiseSpec& spec, NoiseFormat format, const WriteOptions& options,
                        std::vector<std::string>* notes) {
  std::vector<std::string> unread;
  return Writer(spec, format, options, notes != nullptr ? *notes : unread).text();
}

}  // namespace allan_lio
