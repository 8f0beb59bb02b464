// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_noise.h"

#include <cmath>

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

ImuNoise make_imu_noise(const AllanSpec& spec, const NoiseScale& scale, BiasModel model) {
  ImuNoise noise;
  noise.gyro_psd = (scale.k_g * spec.gyro_white).array().square();
  noise.accel_psd = (scale.k_a * spec.accel_white).array().square();
  noise.gyro_bias_psd = bias_psd(scale.k_gb * spec.gyro_bias_instability, spec.gyro_bias_time);
  noise.accel_bias_psd = bias_psd(scale.k_ab * spec.accel_bias_instability, spec.accel_bias_time);
  if (model == BiasModel::kGaussMarkov) {
    noise.gyro_bias_rate = spec.gyro_bias_time.cwiseInverse();
    noise.accel_bias_rate = spec.accel_bias_time.cwiseInverse();
  }
  return noise;
}

}  // namespace allan_lio
