// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "allan_lio/math/time.h"
#include "allan_lio/sim/random.h"

namespace allan_lio {

/// What a real IMU does besides the noise and the bias of its specification. Zero switches an effect off, and every
/// effect draws from a random stream of its own, so that one does not change the values of another.
struct ImuDefects {
  /// Of the gyros (u = rad/s) or the accelerometers (u = m/s^2).
  struct Triad {
    double scale_factor = 0.0;  ///< 1 sigma of the error of each axis's factor [1]
    double misalignment = 0.0;  ///< 1 sigma of each of the six cross-axis terms [rad]
    double vibration = 0.0;     ///< rms of each axis [u]
    double quantization = 0.0;  ///< the least significant bit [u]
    double range = 0.0;         ///< full scale: readings are held within +-range [u]
  };
  Triad gyro, accel;
  double g_sensitivity =
      0.0;  ///< 1 sigma of each of the nine terms by which specific force acts on the gyros [rad/s/(m/s^2)]
  double rectification =
      0.0;  ///< of the accelerometers: a vibration v adds rectification v^2 to the reading [1/(m/s^2)]
  /// Vibration is a Gaussian line of this frequency. Above half the IMU's rate it is seen at its alias [Hz].
  double vibration_frequency = 187.0;
  /// Half width of the line at half its power: the correlation time is 1/(2 pi bandwidth). 0 is a pure tone [Hz].
  double vibration_bandwidth = 2.0;

  double clock_offset = 0.0;     ///< of the IMU's stamps against the LiDAR's at the start [s]
  double clock_drift = 0.0;      ///< how much faster the IMU's clock runs [1]
  double stamp_jitter = 0.0;     ///< 1 sigma, cut at 0.4 intervals so that stamps rise [s]
  double dropped_samples = 0.0;  ///< share of the samples that never come

  bool any() const;
};

/// Throws std::invalid_argument naming what is negative, not finite, or a share above 1.
void check(const ImuDefects& defects);

/// A unit of the MTi-600 class after its factory calibration, on a machine that vibrates; the implementation says
/// where each figure is from.
ImuDefects mti600_defects();

/// One sensor with the defects: constants drawn once, the rest sample by sample.
class ImuDefectModel {
 public:
  /// Throws std::invalid_argument as check() does, or if rate [Hz] is not positive.
  ImuDefectModel(const ImuDefects& defects, double rate, std::uint64_t seed);

  struct Reading {
    Eigen::Vector3d gyro;   ///< [rad/s]
    Eigen::Vector3d accel;  ///< [m/s^2]
  };

  /// What the sensors feel of the true motion at the next sample, before bias and white noise.
  Reading feel(const Reading& truth);

  /// Saturation, then rounding to the least significant bit.
  Reading digitize(const Reading& reading) const;

  /// The next sample's stamp as the IMU's clock gives it, or nothing if the sample is lost. Both since the start.
  std::optional<TimeNs> stamp(TimeNs true_time);

  // The constants that were drawn.
  const Eigen::Matrix3d& gyro_error() const { return gyro_error_; }        ///< reading = (I + error) truth
  const Eigen::Matrix3d& accel_error() const { return accel_error_; }      ///< likewise
  const Eigen::Matrix3d& g_sensitivity() const { return g_sensitivity_; }  ///< gyro += this * specific force

 private:
  /// One axis: the line's complex amplitude, a stationary first-order Gauss-Markov process at the rate of the samples.
  struct Vibration {
    Vibration(const ImuDefects& defects, double rms, double rate, std::uint64_t seed, std::uint64_t stream);
    double next();

    NormalStream normals;
    std::complex<double> amplitude, carrier{1.0, 0.0}, turn;
    double decay, step;
  };
  static Eigen::Vector3d next_of(std::vector<Vibration>& axes);

  ImuDefects defects_;
  double interval_;  // [s]
  Eigen::Matrix3d gyro_error_, accel_error_, g_sensitivity_;
  std::vector<Vibration> gyro_vibration_, accel_vibration_;  // empty: none
  NormalStream jitter_;
  std::uint64_t drop_bits_, sample_ = 0;
};

}  // namespace allan_lio
