// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>

namespace allan_lio {

/// F(lambda) = 1/lambda - (3 - 4 e^-lambda + e^-2lambda) / (2 lambda^2): the Allan variance of a first-order
/// Gauss-Markov process over S_b T_b, lambda = tau/T_b (paper, the equation after `gmmodel`).
double gauss_markov_allan_shape(double lambda);

/// Where F is largest (1.8926) and F there (0.190569), both computed from F.
double gauss_markov_peak_lambda();
double gauss_markov_peak_value();

/// What is known of how a bias wanders (theory section 1, the four inputs; discrete covariances are turned into N
/// and K as they are read).
enum class BiasKind {
  kAllan,        ///< sigma_b on the flat part of the Allan deviation, with T_b
  kRandomWalk,   ///< K, T_b infinite
  kGaussMarkov,  ///< the steady-state standard deviation of a first-order Gauss-Markov process, with T_b
};

/// The noise of a triad of gyros (u = rad/s) or of accelerometers (u = m/s^2), per axis, in SI units. Of the three
/// figures of the bias exactly one is given, the others are zero.
struct SensorNoise {
  Eigen::Vector3d white = Eigen::Vector3d::Zero();             ///< N [u/sqrt(Hz)]
  Eigen::Vector3d bias_instability = Eigen::Vector3d::Zero();  ///< sigma_b, the curve's flat part [u]
  Eigen::Vector3d bias_random_walk = Eigen::Vector3d::Zero();  ///< K [u/s/sqrt(Hz)]
  Eigen::Vector3d bias_sigma = Eigen::Vector3d::Zero();        ///< steady state of a Gauss-Markov bias [u]
  /// T_b [s]; infinite where it is not given, which a random walk needs not.
  Eigen::Vector3d bias_time = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d turn_on_bias = Eigen::Vector3d::Zero();  ///< 1 sigma of the constant part [u]
};

/// What a data sheet, a calibration or an Allan deviation plot states of an IMU.
struct NoiseSpec {
  SensorNoise gyro;   ///< u = rad/s
  SensorNoise accel;  ///< u = m/s^2
};

/// By which figure the bias is given: the one that is not zero (the first in the order of BiasKind).
BiasKind bias_kind(const SensorNoise& sensor);

/// 1 sigma of the bias apart from its turn-on part [u]: sigma_b, the Gauss-Markov process's deviation, or what a
/// random walk does in a minute.
Eigen::Vector3d bias_spread(const SensorNoise& sensor);

/// S_b per axis [u^2/s]: sigma_b^2/(F(lambda*) T_b) (paper, `new_S`, with the constant computed instead of 5.25),
/// K^2, or 2 sigma^2/T_b.
Eigen::Vector3d bias_psd(const SensorNoise& sensor);

/// S_b = sigma_b^2 / (F(lambda*) T_b) per axis.
Eigen::Vector3d bias_psd(const Eigen::Vector3d& sigma_b, const Eigen::Vector3d& correlation_time);

/// The same S_b told by another figure, N and the turn-on bias as they are. `bias_time` [s] stands in where the
/// sensor has no T_b of its own; the result of kRandomWalk has none. Throws std::invalid_argument if a T_b is needed
/// and neither is finite and positive.
SensorNoise convert_bias(const SensorNoise& sensor, BiasKind kind, double bias_time);

/// T_b = tau_flat / lambda*.
double correlation_time_from_flat(double tau_flat);

/// The covariances of single samples that a filter with a fixed rate takes (paper, `Qk_with_S`: Q_d = S / dt), as
/// FAST-LIO2's gyr_cov and b_gyr_cov.
struct DiscreteNoise {
  Eigen::Vector3d white = Eigen::Vector3d::Zero();  ///< [u^2]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();   ///< [(u/s)^2]
};

/// `rate` [Hz] must be positive.
DiscreteNoise to_discrete(const SensorNoise& sensor, double rate);

/// S = Q_d dt: N and K by which the covariances are told at `rate` [Hz].
SensorNoise from_discrete(const DiscreteNoise& discrete, double rate);

/// The multipliers of the paper's section 3. Each scales an amplitude, so it enters S squared.
struct NoiseScale {
  double k_g = 1.0;   ///< on N_g
  double k_a = 1.0;   ///< on N_a
  double k_gb = 1.0;  ///< on sigma_bg
  double k_ab = 1.0;  ///< on sigma_ba
};

/// By how much each amplitude of `asked` exceeds that of `known`: the k's that would make `known` behave like it.
/// The axes are averaged in S. An amplitude that is zero in `known` gives infinity, or 1 if it is zero in both.
NoiseScale implied_scale(const NoiseSpec& asked, const NoiseSpec& known);

enum class BiasModel {
  kRandomWalk,   ///< b' = w, T = infinity
  kGaussMarkov,  ///< b' = -(b - mean)/T + w (paper, `gmmodel`), the mean being a constant, the turn-on bias
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

/// A bias told by a random walk alone stays one under either model.
ImuNoise make_imu_noise(const NoiseSpec& spec, const NoiseScale& scale, BiasModel model);

}  // namespace allan_lio
