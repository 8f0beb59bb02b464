// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/imu_yaml.h"

namespace allan_lio {
namespace {

NoiseFigure config_figure(const ConfigSource& source, const char* name, bool gyro, FigureKind kind, Dimension dimension,
                          const Eigen::Vector3d& value) {
  const auto at = source.find(std::string("imu/noise/") + (gyro ? "gyro_" : "accel_") + name + "/value");
  if (at == source.end()) throw ConfigError(std::string("imu/noise: ") + name + " is missing");
  NoiseFigure figure;
  figure.key = at->first;
  figure.origin = at->second.origin;
  figure.gyro = gyro;
  figure.kind = kind;
  figure.unit = si_unit(dimension);
  figure.value = value;
  return figure;
}

NoiseFigure config_bias(const ConfigSource& source, bool gyro, const SensorNoise& sensor) {
  const Dimension level = gyro ? Dimension::kAngularRate : Dimension::kAcceleration;
  switch (bias_kind(sensor)) {
    case BiasKind::kAllan:
      return config_figure(source, "bias_instability", gyro, FigureKind::kBiasInstability, level,
                           sensor.bias_instability);
    case BiasKind::kRandomWalk:
      return config_figure(source, "bias_random_walk", gyro, FigureKind::kRandomWalk,
                           gyro ? Dimension::kGyroRandomWalk : Dimension::kAccelRandomWalk, sensor.bias_random_walk);
    case BiasKind::kGaussMarkov:
      return config_figure(source, "bias_sigma", gyro, FigureKind::kBiasSigma, level, sensor.bias_sigma);
  }
  throw std::invalid_argument("config_bias: unknown kind");
}

}  // namespace

NoiseFile read_noise_config(const ConfigSource& source, const std::string& name) {
  ConfigSource noise;
  for (const auto& item : source)
    if (item.first.compare(0, 10, "imu/noise/") == 0) noise.insert(item);
  NoiseFile file;
  try {
    file.spec = read_config(noise).imu.spec;
  } catch (const ConfigError& error) {
    throw ConfigError(name + ": " + error.what());
  }
  const NoiseSpec& spec = file.spec;
  file.figures = {
      config_figure(noise, "white_noise", true, FigureKind::kDensity, Dimension::kGyroWhiteNoise, spec.gyro.white),
      config_figure(noise, "white_noise", false, FigureKind::kDensity, Dimension::kAccelWhiteNoise, spec.accel.white),
      config_bias(noise, true, spec.gyro), config_bias(noise, false, spec.accel)};
  return file;
}

}  // namespace allan_lio
