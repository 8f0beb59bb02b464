// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/noise_report.h"

#include <cmath>
#include <locale>
#include <sstream>

#include "allan_lio/imu/noise_units.h"

namespace allan_lio {
namespace {

constexpr int kDigits = 4;

std::string short_text(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(kDigits);
  out << value;
  return out.str();
}

/// How one sensor's quantities are called and in which unit its data sheets speak.
struct Words {
  const char *name, *letter, *unit, *step, *sheet_white, *sheet_bias;
  Dimension white, bias;
};

const Words kGyro = {
    "gyro", "g", "rad/s", "rad/s^2", "deg/sqrt(h)", "deg/h", Dimension::kGyroWhiteNoise, Dimension::kAngularRate};
const Words kAccel = {"accelerometer",         "a", "m/s^2", "m/s^3", "ug/sqrt(Hz)", "ug", Dimension::kAccelWhiteNoise,
                      Dimension::kAcceleration};

void describe_sensor(const Words& words, SensorNoise sensor, double k, double k_bias, double rate,
                     std::vector<std::string>* lines) {
  const std::string unit = words.unit, letter = words.letter, step = words.step, squared = "(" + unit + ")^2";
  sensor.white *= k;
  for (Eigen::Vector3d* figure : {&sensor.bias_instability, &sensor.bias_random_walk, &sensor.bias_sigma})
    *figure *= k_bias;
  const DiscreteNoise discrete = to_discrete(sensor, rate);
  const Eigen::Vector3d density = bias_psd(sensor);

  lines->push_back(std::string(words.name) + " white noise: N_" + letter + " = " +
                   axes_text_in(sensor.white, words.sheet_white, words.white) + " (k_" + letter + " = " +
                   short_text(k) + "), S = " + axes_text(sensor.white.cwiseAbs2(), squared + "/Hz") +
                   "; a sample has the deviation " + axes_text(discrete.white.cwiseSqrt(), unit) + ", covariance " +
                   axes_text(discrete.white, squared));
  std::string bias = std::string(words.name) + " bias: ";
  if (sensor.bias_time.allFinite()) {
    const SensorNoise allan = convert_bias(sensor, BiasKind::kAllan, 0.0);
    const SensorNoise markov = convert_bias(sensor, BiasKind::kGaussMarkov, 0.0);
    bias += "sigma_b" + letter + " = " + axes_text_in(allan.bias_instability, words.sheet_bias, words.bias) + ", T_b" +
            letter + " = " + axes_text(sensor.bias_time, "s") + " (Gauss-Markov deviation " +
            axes_text_in(markov.bias_sigma, words.sheet_bias, words.bias) + ")";
  } else {
    bias += "a random walk";
  }
  lines->push_back(bias + " (k_" + letter + "b = " + short_text(k_bias) +
                   "), S = " + axes_text(density, squared + "/s") +
                   "; as random walk K = " + axes_text(density.cwiseSqrt(), step + "/sqrt(Hz)") +
                   ", covariance of a step " + axes_text(discrete.bias, "(" + step + ")^2"));
}

}  // namespace

std::string axes_text(const Eigen::Vector3d& value, const std::string& unit) {
  constexpr double kRounding = 1e-9;
  const bool same = (value.array() - value[0]).abs().maxCoeff() <= kRounding * std::abs(value[0]);
  std::string text = short_text(value[0]);
  if (!same) text += ", " + short_text(value[1]) + ", " + short_text(value[2]);
  return text + " " + unit;
}

std::string axes_text_in(const Eigen::Vector3d& value, const std::string& unit, Dimension dimension) {
  return axes_text(value / convert_unit(unit, dimension).to_si, unit);
}

std::vector<std::string> describe_noise(const NoiseSpec& spec, const NoiseScale& scale, double rate) {
  std::vector<std::string> lines = {"IMU noise in force; per-sample values hold at the measured " + short_text(rate) +
                                    " Hz and are what filters with discrete covariances take"};
  describe_sensor(kGyro, spec.gyro, scale.k_g, scale.k_gb, rate, &lines);
  describe_sensor(kAccel, spec.accel, scale.k_a, scale.k_ab, rate, &lines);
  return lines;
}

}  // namespace allan_lio
