// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "allan_lio/imu/physical_unit.h"
#include "allan_lio/io/allan_report.h"

namespace allan_lio {
namespace {

constexpr int kDigits = 6, kBoundDigits = 3;
constexpr double kStandardGravity = 9.80665;  // [m/s^2]

/// One key with its figure of three axes.
struct Figure {
  std::string key, unit;
  std::array<Estimate, 3> axes;
};

/// "at most 3.2" of an estimate that is only bounded.
std::string bound_text(const Estimate& estimate, double unit) {
  if (std::isfinite(estimate.high)) return "at most " + rounded_text(estimate.high / unit, kBoundDigits);
  if (estimate.low > 0.0) return "at least " + rounded_text(estimate.low / unit, kBoundDigits);
  return "without a bound";
}

std::string value_list(const Figure& figure, double unit) {
  std::string list;
  for (const Estimate& axis : figure.axes)
    list += (list.empty() ? "" : ", ") + (axis.observable ? rounded_text(axis.value / unit, kDigits) : "?");
  return list;
}

void add_figure(const Figure& figure, NoiseYaml& yaml) {
  const double unit = parse_unit(figure.unit).factor;
  std::string bounds;
  for (int i = 0; i < 3; ++i) {
    const Estimate& axis = figure.axes[static_cast<std::size_t>(i)];
    if (axis.observable) continue;
    bounds += (bounds.empty() ? "" : "; ") + std::string(1, static_cast<char>('x' + i)) + " " + bound_text(axis, unit);
  }
  const std::string line = figure.key + ": {value: [" + value_list(figure, unit) + "], unit: " + figure.unit + "}";
  if (bounds.empty()) {
    yaml.text += "    " + line + "\n";
    return;
  }
  yaml.text +=
      "    # not observable in this record, " + bounds + " " + figure.unit + " (95 %); fill in and uncomment:\n";
  yaml.text += "    # " + line + "\n";
  yaml.missing.push_back(figure.key + " is not observable in this record: " + bounds + " " + figure.unit);
}

template <class Pick>
Figure make_figure(const std::string& key, const std::string& unit, const RecordAnalysis& analysis, bool gyro,
                   const Pick& pick) {
  Figure figure{key, unit, {}};
  for (std::size_t i = 0; i < 3; ++i) figure.axes[i] = pick(analysis.axes[i + (gyro ? 0 : 3)].analysis);
  return figure;
}

void add_bias(const RecordAnalysis& analysis, BiasOutput bias, bool gyro, NoiseYaml& yaml) {
  const std::string sensor = gyro ? "gyro" : "accel";
  const auto add = [&](const std::string& key, const std::string& unit, const auto& pick) {
    add_figure(make_figure(sensor + key, unit, analysis, gyro, pick), yaml);
  };
  if (bias == BiasOutput::kRandomWalk) {
    add("_bias_random_walk", gyro ? "rad/s^2/sqrt(Hz)" : "m/s^3/sqrt(Hz)",
        [](const AxisAnalysis& a) { return a.best().random_walk; });
    return;
  }
  const bool flat = bias == BiasOutput::kFlat;
  add("_bias_instability", gyro ? "deg/h" : "ug",
      [flat](const AxisAnalysis& a) { return flat ? a.flat.deviation : a.markov.markov_flat; });
  add("_bias_time", "s", [flat](const AxisAnalysis& a) { return flat ? a.flat.bias_time : a.markov.markov_time; });
}

/// What one switch-on tells of the constant biases: one sample of each.
void add_turn_on(const RecordAnalysis& analysis, NoiseYaml& yaml) {
  double gyro = 0.0, accel = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    gyro += analysis.axes[i].mean * analysis.axes[i].mean / 3.0;
    accel += analysis.axes[i + 3].mean * analysis.axes[i + 3].mean;
  }
  const double error = std::abs(std::sqrt(accel) - kStandardGravity);
  yaml.text +=
      "    # One switch-on is one sample of a turn-on bias: rms of the mean rates (the earth's included), and mean\n"
      "    # |specific force| less 9.80665 m/s^2. Replace them by the spread over several switch-ons.\n"
      "    gyro_turn_on_bias: {value: " +
      rounded_text(std::sqrt(gyro) / parse_unit("deg/s").factor, kDigits) +
      ", unit: deg/s}\n    accel_turn_on_bias: {value: " + rounded_text(error / parse_unit("mg").factor, kDigits) +
      ", unit: mg}\n";
}

std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

std::string describe(BiasOutput bias) {
  switch (bias) {
    case BiasOutput::kFlat:
      return "flat part (minimum of the fitted curve, or a Gauss-Markov bias's own peak), T_b = tau_flat / 1.8926";
    case BiasOutput::kGaussMarkov:
      return "Gauss-Markov bias of the fit";
    case BiasOutput::kRandomWalk:
      return "random walk K of the fit";
  }
  return "";
}

std::string header(const RecordAnalysis& analysis, const RecordOrigin& origin, BiasOutput bias) {
  std::string text =
      "# Noise of an IMU by allan_variance from a static record.\n#   record:      " + one_line(origin.name) +
      "\n#   length:      " + rounded_text(analysis.duration, kDigits) + " s at " +
      rounded_text(1.0 / analysis.tau0, kDigits) + " Hz\n#   temperature: ";
  text += origin.temperature.known()
              ? rounded_text(origin.temperature.low, 4) + " to " + rounded_text(origin.temperature.high, 4) + " degC\n"
              : "not recorded\n";
  text += "#   method:      ";
  text += analysis.method == FitMethod::kLeastSquares
              ? "weighted non-negative least squares of the overlapping Allan variances\n"
              : "maximum likelihood\n";
  text += "#   bias:        " + describe(bias) + "\n";
  for (const std::string& remark : origin.remarks) text += "#   note:        " + one_line(remark) + "\n";
  return text;
}

}  // namespace

NoiseYaml noise_yaml(const RecordAnalysis& analysis, const RecordOrigin& origin, BiasOutput bias) {
  NoiseYaml yaml;
  yaml.text = header(analysis, origin, bias) + "imu:\n  noise:\n";
  const auto white = [](const AxisAnalysis& a) { return a.best().white; };
  add_figure(make_figure("gyro_white_noise", "deg/sqrt(h)", analysis, true, white), yaml);
  add_figure(make_figure("accel_white_noise", "ug/sqrt(Hz)", analysis, false, white), yaml);
  add_bias(analysis, bias, true, yaml);
  add_bias(analysis, bias, false, yaml);
  add_turn_on(analysis, yaml);
  return yaml;
}

}  // namespace allan_lio
