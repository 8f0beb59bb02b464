// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace allan_lio {

/// F(lambda) = 1/lambda - (3 - 4 e^-lambda + e^-2lambda) / (2 lambda^2): the Allan variance of a first-order
/// Gauss-Markov process over S_b T_b, lambda = tau/T_b (paper, the equation after `gmmodel`).
double gauss_markov_allan_shape(double lambda);

/// Where F is largest (1.8926) and F there (0.190569), both computed from F.
double gauss_markov_peak_lambda();
double gauss_markov_peak_value();

/// What a data sheet or an Allan deviation plot states, per IMU axis, in SI units.
struct AllanSpec {
  Eigen::Vector3d gyro_white = Eigen::Vector3d::Zero();              ///< N_g [rad/s/sqrt(Hz)]
  Eigen::Vector3d accel_white = Eigen::Vector3d::Zero();             ///< N_a [m/s^2/sqrt(Hz)]
  Eigen::Vector3d gyro_bias_instability = Eigen::Vector3d::Zero();   ///< sigma_bg, the curve's flat part [rad/s]
  Eigen::Vector3d accel_bias_instability = Eigen::Vector3d::Zero();  ///< sigma_ba [m/s^2]
  Eigen::Vector3d gyro_bias_time = Eigen::Vector3d::Ones();          ///< T_bg [s]
  Eigen::Vector3d accel_bias_time = Eigen::Vector3d::Ones();         ///< T_ba [s]
  Eigen::Vector3d gyro_turn_on_bias = Eigen::Vector3d::Zero();       ///< 1 sigma of the constant part [rad/s]
  Eigen::Vector3d accel_turn_on_bias = Eigen::Vector3d::Zero();      ///< 1 sigma of the constant part [m/s^2]
};

/// The multipliers of the paper's section 3. Each scales an amplitude, so it enters S squared.
struct NoiseScale {
  double k_g = 1.0;   ///< on N_g
  double k_a = 1.0;   ///< on N_a
  double k_gb = 1.0;  ///< on sigma_bg
  double k_ab = 1.0;  ///< on sigma_ba
};

enum class BiasModel {
  kRandomWalk,   ///< b' = w, T = infinity: the turn-on bias stays unknown for ever
  kGaussMarkov,  ///< b' = -b/T + w (paper, `gmmodel`): decays to zero, for an IMU whose turn-on bias is removed
};

/// The continuous-time noise that every estimator on this core uses: the diagonal of
/// S = diag(N_g^2, N_a^2, S_bg, S_ba), per axis, and the bias correlation times.
struct ImuNoise {
  Eigen::Vector3d gyro_psd = Eigen::Vector3d::Zero();        ///< N_g^2 [(rad/s)^2/Hz]
  Eigen::Vector3d accel_psd = Eigen::Vector3d::Zero();       ///< N_a^2 [(m/s^2)^2/Hz]
  Eigen::Vector3d gyro_bias_psd = Eigen::Vector3d::Zero();   ///< S_bg [(rad/s)^2/s]
  Eigen::Vector3d accel_bias_psd = Eigen::Vector3d::Zero();  ///< S_ba [(m/s^2)^2/s]
  /// 1/T_b [1/s]; 0 is the random walk.
  Eigen::Vector3d gyro_bias_rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel_bias_rate = Eigen::Vector3d::Zero();

  /// S as a 12-vector in the order gyro, accel, gyro bias, accel bias.
  Eigen::Matrix<double, 12, 1> spectral_density() const;
};

/// S_b = sigma_b^2 / (F(lambda*) T_b) per axis (paper, `new_S`, with the constant computed instead of 5.25).
Eigen::Vector3d bias_psd(const Eigen::Vector3d& sigma_b, const Eigen::Vector3d& correlation_time);

/// T_b = tau_flat / lambda*.
double correlation_time_from_flat(double tau_flat);

ImuNoise make_imu_noise(const AllanSpec& spec, const NoiseScale& scale, BiasModel model);

}  // namespace allan_lio
