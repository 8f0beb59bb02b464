// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/noise_text.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "allan_lio/imu/physical_unit.h"
#include "noise_slips.h"

namespace allan_lio {
namespace {

/// "0.42", or "[0.42, 0.42, 0.5]" where the axes differ in the digits shown.
std::string axes_text(const Eigen::Vector3d& v) {
  const std::string x = short_text(v.x()), y = short_text(v.y()), z = short_text(v.z());
  return x == y && y == z ? x : "[" + x + ", " + y + ", " + z + "]";
}

/// The SI values in each of the units: "0.0001222 rad/s/sqrt(Hz) = 0.42 deg/sqrt(h)".
std::string in_units(const Eigen::Vector3d& si, const std::vector<std::string>& units) {
  std::string text;
  for (const std::string& unit : units)
    text += (text.empty() ? "" : " = ") + axes_text(si / parse_unit(unit).factor) + " " + unit;
  return text;
}

std::vector<std::string> white_units(bool gyro) {
  if (gyro) return {"rad/s/sqrt(Hz)", "deg/sqrt(h)", "deg/s/sqrt(Hz)"};
  return {"m/s^2/sqrt(Hz)", "m/s/sqrt(h)", "ug/sqrt(Hz)"};
}

std::vector<std::string> level_units(bool gyro) {
  if (gyro) return {"rad/s", "deg/h"};
  return {"m/s^2", "ug", "mGal"};
}

std::vector<std::string> walk_units(bool gyro) {
  if (gyro) return {"rad/s^2/sqrt(Hz)", "deg/h/sqrt(h)"};
  return {"m/s^3/sqrt(Hz)", "ug*sqrt(Hz)"};
}

std::string time_text(const Eigen::Vector3d& bias_time) {
  return "T_b = " + axes_text(bias_time) + " s (flat at " + axes_text(bias_time * gauss_markov_peak_lambda()) + " s)";
}

/// What a bias figure means, whichever way it is told: K, and sigma_b with its own T_b or else that of `known`.
std::string bias_meaning(const SensorNoise& sensor, bool gyro, const KnownImu* known) {
  SensorNoise filled = sensor;
  std::string whose;
  const double missing = known == nullptr ? std::numeric_limits<double>::infinity()
                                          : (gyro ? known->spec.gyro : known->spec.accel).bias_time.mean();
  if (!sensor.bias_time.allFinite() && std::isfinite(missing)) {
    filled.bias_time.setConstant(missing);
    whose = ", that of " + known->name;
  }
  if (bias_kind(sensor) == BiasKind::kRandomWalk) {
    std::string text = in_units(sensor.bias_random_walk, walk_units(gyro));
    if (std::isfinite(missing)) {
      const SensorNoise level = convert_bias(sensor, BiasKind::kAllan, missing);
      text += "; as sigma_b " + in_units(level.bias_instability, level_units(gyro)) + " with " +
              time_text(level.bias_time) + whose;
    }
    return text;
  }
  const bool allan = bias_kind(sensor) == BiasKind::kAllan;
  std::string text = in_units(allan ? sensor.bias_instability : sensor.bias_sigma, level_units(gyro));
  if (filled.bias_time.allFinite()) {
    const SensorNoise walk = convert_bias(filled, BiasKind::kRandomWalk, 0.0);
    text +=
        "; as K " + in_units(walk.bias_random_walk, walk_units(gyro)) + " with " + time_text(filled.bias_time) + whose;
  }
  return text;
}

std::string k_line(const ImpliedScale& implied, const std::string& mark) {
  const auto column = [](double k) {
    std::string text = k_text(k);
    text.insert(0, text.size() < 9 ? 9 - text.size() : 1, ' ');
    return text;
  };
  std::string name = implied.name;
  name.resize(std::max<std::size_t>(name.size() + 1, 18), ' ');
  return "  " + name + column(implied.k.k_g) + column(implied.k.k_a) + column(implied.k.k_gb) + column(implied.k.k_ab) +
         mark + "\n";
}

std::string sensor_text(const SensorNoise& sensor, bool gyro, double rate, double bias_time) {
  std::string text = gyro ? "gyro\n" : "accelerometer\n";
  text += "  white noise   N = " + in_units(sensor.white, white_units(gyro)) + "\n";
  SensorNoise own = sensor;
  const bool given = own.bias_time.allFinite();
  if (!given && bias_time > 0.0) own.bias_time.setConstant(bias_time);
  const std::string whose = given || bias_time <= 0.0 ? "" : ", as asked";
  if (own.bias_time.allFinite()) {
    const SensorNoise allan = convert_bias(own, BiasKind::kAllan, bias_time);
    const SensorNoise markov = convert_bias(own, BiasKind::kGaussMarkov, bias_time);
    text += "  Allan         sigma_b = " + in_units(allan.bias_instability, level_units(gyro)) + " with " +
            time_text(allan.bias_time) + whose + "\n";
    text += "  Gauss-Markov  sigma = " + in_units(markov.bias_sigma, level_units(gyro)) +
            " with T_b = " + axes_text(markov.bias_time) + " s" + whose + "\n";
  } else {
    text += "  Allan, Gauss-Markov: a correlation time is needed, give --bias-time\n";
  }
  if (own.bias_time.allFinite() || bias_kind(own) == BiasKind::kRandomWalk) {
    text += "  random walk   K = " +
            in_units(convert_bias(own, BiasKind::kRandomWalk, 0.0).bias_random_walk, walk_units(gyro)) + "\n";
  } else {
    text += "  random walk: a correlation time is needed, give --bias-time\n";
    return text;
  }
  if (rate <= 0.0) return text + "  samples: the rate is needed, give --rate\n";
  const DiscreteNoise discrete = to_discrete(own, rate);
  const std::string u = gyro ? "rad/s" : "m/s^2", w = gyro ? "rad/s^2" : "m/s^3";
  return text + "  samples at " + short_text(rate) + " Hz: covariance " + axes_text(discrete.white) + " (" + u +
         ")^2, sigma " + axes_text(discrete.white.cwiseSqrt()) + " " + u + "; bias " + axes_text(discrete.bias) + " (" +
         w + ")^2\n";
}

std::string notes_text(const NoiseFile& file) {
  std::string text;
  for (const std::string& note : file.notes) text += "note: " + note + "\n";
  return text;
}

}  // namespace

std::string lint_text(const LintReport& report) {
  const NoiseFile& file = report.file;
  std::string text = "format: " + noise_format_name(file.format);
  if (file.rate > 0.0) text += ", " + short_text(file.rate) + " Hz";
  text += "\n";
  const KnownImu* reference =
      report.reference < 0 ? nullptr : &report.known[static_cast<std::size_t>(report.reference)];
  for (const NoiseFigure& figure : file.figures) {
    const SensorNoise& sensor = figure.gyro ? file.spec.gyro : file.spec.accel;
    text += figure.key + " = " + axes_text(figure.value) + " " + figure.unit + "  (" + figure.origin + ")\n    ";
    if (figure.value.isZero(0)) {
      text += "zero\n";
      continue;
    }
    text += (is_white(figure.kind) ? in_units(sensor.white, white_units(figure.gyro))
                                   : bias_meaning(sensor, figure.gyro, reference)) +
            "\n";
  }
  if (!report.implied.empty()) text += "implied k against         k_g      k_a     k_gb     k_ab\n";
  for (std::size_t i = 0; i < report.implied.size(); ++i)
    text += k_line(report.implied[i], static_cast<int>(i) == report.nearest ? "  nearest" : "");
  text += notes_text(file);
  for (const LintFinding& finding : report.findings)
    text += (finding.suspicious ? "suspicious: " : "note: ") + finding.sentence + "\n";
  return text + (report.suspicious() ? "" : "nothing suspicious\n");
}

std::string show_text(const NoiseFile& file, double bias_time) {
  return "format: " + noise_format_name(file.format) + "\n" + sensor_text(file.spec.gyro, true, file.rate, bias_time) +
         sensor_text(file.spec.accel, false, file.rate, bias_time) + notes_text(file);
}

}  // namespace allan_lio
