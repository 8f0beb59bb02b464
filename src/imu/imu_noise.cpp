// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_noise.h"

#include <cmath>
#include <stdexcept>

namespace allan_lio {
namespace {

/// The root of F'(lambda), times lambda^3: -lambda + 3 - 4 e^-lambda + e^-2lambda - 2 lambda e^-lambda + lambda
/// e^-2lambda.
double shape_slope(double lambda) {
  const double e1 = std::exp(-lambda), e2 = std::exp(-2.0 * lambda);
  return -lambda + 3.0 - 4.0 * e1 + e2 - lambda * (2.0 * e1 - e2);
}

double find_peak() {
  double low = 1.0, high = 3.0;  // the slope is positive at 1 and negative at 3
  while (high - low > 1e-15 * high) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (shape_slope(middle) > 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double gauss_markov_allan_shape(double lambda) {
  if (lambda < 1e-3) return lambda / 3.0 - lambda * lambda / 4.0;  // cancellation below
  const double e1 = std::exp(-lambda), e2 = std::exp(-2.0 * lambda);
  return 1.0 / lambda - (3.0 - 4.0 * e1 + e2) / (2.0 * lambda * lambda);
}

double gauss_markov_peak_lambda() {
  static const double peak = find_peak();
  return peak;
}

double gauss_markov_peak_value() { return gauss_markov_allan_shape(gauss_markov_peak_lambda()); }

Eigen::Matrix<double, 12, 1> ImuNoise::spectral_density() const {
  Eigen::Matrix<double, 12, 1> s;
  s << gyro_psd, accel_psd, gyro_bias_psd, accel_bias_psd;
  return s;
}

Eigen::Vector3d bias_psd(const Eigen::Vector3d& sigma_b, const Eigen::Vector3d& correlation_time) {
  return (sigma_b.array().square() / (gauss_markov_peak_value() * correlation_time.array())).matrix();
}

double correlation_time_from_flat(double tau_flat) { return tau_flat / gauss_markov_peak_lambda(); }

BiasKind bias_kind(const SensorNoise& sensor) {
  if (!sensor.bias_instability.isZero(0)) return BiasKind::kAllan;
  return sensor.bias_random_walk.isZero(0) ? BiasKind::kGaussMarkov : BiasKind::kRandomWalk;
}

Eigen::Vector3d bias_spread(const SensorNoise& sensor) {
  constexpr double kMinute = 60.0;  // [s]
  return sensor.bias_instability + std::sqrt(kMinute) * sensor.bias_random_walk + sensor.bias_sigma;
}

Eigen::Vector3d bias_psd(const SensorNoise& sensor) {
  switch (bias_kind(sensor)) {
    case BiasKind::kAllan:
      return bias_psd(sensor.bias_instability, sensor.bias_time);
    case BiasKind::kRandomWalk:
      return sensor.bias_random_walk.array().square().matrix();
    case BiasKind::kGaussMarkov:
      return (2.0 * sensor.bias_sigma.array().square() / sensor.bias_time.array()).matrix();
  }
  throw std::invalid_argument("bias_psd: unknown kind");
}

SensorNoise convert_bias(const SensorNoise& sensor, BiasKind kind, double bias_time) {
  SensorNoise result;
  result.white = sensor.white;
  result.turn_on_bias = sensor.turn_on_bias;
  const Eigen::Array3d density = bias_psd(sensor).array();
  if (kind == BiasKind::kRandomWalk) {
    result.bias_random_walk = density.sqrt().matrix();
    return result;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double own = sensor.bias_time[axis];
    result.bias_time[axis] = std::isfinite(own) ? own : bias_time;
  }
  if (!(result.bias_time.minCoeff() > 0 && result.bias_time.allFinite()))
    throw std::invalid_argument("a bias correlation time is needed: a random walk has none of its own");
  if (kind == BiasKind::kAllan) {
    result.bias_instability = (density * gauss_markov_peak_value() * result.bias_time.array()).sqrt().matrix();
  } else {
    result.bias_sigma = (0.5 * density * result.bias_time.array()).sqrt().matrix();
  }
  return result;
}

DiscreteNoise to_discrete(const SensorNoise& sensor, double rate) {
  return {rate * sensor.white.array().square().matrix(), rate * bias_psd(sensor)};
}

SensorNoise from_discrete(const DiscreteNoise& discrete, double rate) {
  SensorNoise sensor;
  sensor.white = (discrete.white.array() / rate).sqrt().matrix();
  sensor.bias_random_walk = (discrete.bias.array() / rate).sqrt().matrix();
  return sensor;
}

NoiseScale implied_scale(const NoiseSpec& asked, const NoiseSpec& known) {
  const auto ratio = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a.isZero(0) && b.isZero(0) ? 1.0 : std::sqrt(a.sum() / b.sum());
  };
  NoiseScale scale;
  scale.k_g = ratio(asked.gyro.white.cwiseAbs2(), known.gyro.white.cwiseAbs2());
  scale.k_a = ratio(asked.accel.white.cwiseAbs2(), known.accel.white.cwiseAbs2());
  scale.k_gb = ratio(bias_psd(asked.gyro), bias_psd(known.gyro));
  scale.k_ab = ratio(bias_psd(asked.accel), bias_psd(known.accel));
  return scale;
}

ImuNoise make_imu_noise(const NoiseSpec& spec, const NoiseScale& scale, BiasModel model) {
  ImuNoise noise;
  noise.gyro_psd = (scale.k_g * spec.gyro.white).array().square();
  noise.accel_psd = (scale.k_a * spec.accel.white).array().square();
  noise.gyro_bias_psd = scale.k_gb * scale.k_gb * bias_psd(spec.gyro);
  noise.accel_bias_psd = scale.k_ab * scale.k_ab * bias_psd(spec.accel);
  if (model == BiasModel::kGaussMarkov) {
    noise.gyro_bias_rate = spec.gyro.bias_time.cwiseInverse();
    noise.accel_bias_rate = spec.accel.bias_time.cwiseInverse();
  }
  return noise;
}

}  // namespace allan_lio
