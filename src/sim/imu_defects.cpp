// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/imu_defects.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace allan_lio {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
constexpr double kJitterLimit = 0.4;  // of the interval

// Streams of NormalStream; the noise and the bias come from other generators (imu_simulator.cpp).
constexpr std::uint64_t kGyroScale = 101, kAccelScale = 102, kGyroCross = 103, kAccelCross = 104, kGSensitivity = 105,
                        kGyroVibration = 110, kAccelVibration = 120, kJitter = 130, kDrop = 131;

Eigen::Matrix3d draw_error(const ImuDefects::Triad& triad, std::uint64_t seed, std::uint64_t scale,
                           std::uint64_t cross) {
  NormalStream scales(seed, scale), angles(seed, cross);
  Eigen::Matrix3d error;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      error(row, column) = row == column ? triad.scale_factor * scales.next() : triad.misalignment * angles.next();
  return error;
}

Eigen::Vector3d digitized(const Eigen::Vector3d& value, const ImuDefects::Triad& triad) {
  Eigen::Vector3d out = value;
  for (double& x : out) {
    if (triad.quantization > 0) x = triad.quantization * std::round(x / triad.quantization);
    if (triad.range > 0) x = std::clamp(x, -triad.range, triad.range);
  }
  return out;
}

}  // namespace

bool ImuDefects::any() const {
  const auto in_triad = [](const Triad& t) {
    return t.scale_factor > 0 || t.misalignment > 0 || t.vibration > 0 || t.quantization > 0 || t.range > 0;
  };
  return in_triad(gyro) || in_triad(accel) || g_sensitivity > 0 || clock_offset != 0 || clock_drift != 0 ||
         stamp_jitter > 0 || dropped_samples > 0;
}

void check(const ImuDefects& d) {
  const auto require = [](bool good, const std::string& name, const char* rule) {
    if (!good) throw std::invalid_argument("the IMU error '" + name + "' " + rule);
  };
  const auto not_negative = [&](double value, const std::string& name) {
    require(value >= 0 && std::isfinite(value), name, "must not be negative");
  };
  for (const auto& [name, triad] : {std::pair<std::string, ImuDefects::Triad>{"gyro_", d.gyro}, {"accel_", d.accel}}) {
    require(triad.scale_factor >= 0 && triad.scale_factor < 1, name + "scale_factor", "must lie between 0 and 1");
    require(triad.misalignment >= 0 && triad.misalignment < 1, name + "misalignment", "must lie between 0 and 1 rad");
    not_negative(triad.vibration, name + "vibration");
    not_negative(triad.quantization, name + "quantization");
    not_negative(triad.range, name + "range");
  }
  not_negative(d.g_sensitivity, "g_sensitivity");
  not_negative(d.rectification, "rectification");
  not_negative(d.vibration_frequency, "vibration_frequency");
  not_negative(d.vibration_bandwidth, "vibration_bandwidth");
  require(std::abs(d.clock_offset) <= 10, "clock_offset", "must lie between -10 and 10 s");
  require(std::abs(d.clock_drift) <= 0.1, "clock_drift", "must lie between -10 and 10 %");
  not_negative(d.stamp_jitter, "stamp_jitter");
  require(d.dropped_samples >= 0 && d.dropped_samples < 1, "dropped_samples", "must lie between 0 and 1");
}

ImuDefects mti600_defects() {
  constexpr double kDegree = kTwoPi / 360.0, kG = 9.80665;
  ImuDefects d;
  // Orthogonality 0.05 deg and the ranges: the data sheet's, quoted from memory of it, as is the g-sensitivity of
  // 0.001 deg/s/g after calibration. Not yet compared with the document.
  d.gyro.misalignment = d.accel.misalignment = 0.05 * kDegree;
  d.gyro.range = 2000 * kDegree;
  d.accel.range = 10 * kG;
  d.g_sensitivity = 0.001 * kDegree / kG;
  // Estimates, the order of a calibrated MEMS unit: the sheet tells non-linearity (0.1 % of full scale) and no scale
  // error; 16 bits over the full range.
  d.gyro.scale_factor = d.accel.scale_factor = 500e-6;
  d.gyro.quantization = 2 * d.gyro.range / 65536;
  d.accel.quantization = 2 * d.accel.range / 65536;
  // Estimates: what a strapdown integration at 2 kHz leaves of a motor's vibration, 0.05 m/s^2 and 0.1 deg/s rms.
  d.accel.vibration = 0.05;
  d.gyro.vibration = 0.1 * kDegree;
  d.rectification = 100e-6 / kG;  // 100 ug/g^2
  // Estimates: a serial link without a synchronisation line, stamped on arrival; a crystal of 10 ppm.
  d.clock_offset = 1e-3;
  d.clock_drift = 10e-6;
  d.stamp_jitter = 0.2e-3;
  d.dropped_samples = 1e-4;
  return d;
}

ImuDefectModel::Vibration::Vibration(const ImuDefects& defects, double rms, double rate, std::uint64_t seed,
                                     std::uint64_t stream)
    : normals(seed, stream),
      turn(std::polar(1.0, kTwoPi * std::fmod(defects.vibration_frequency, rate) / rate)),
      decay(std::exp(-kTwoPi * defects.vibration_bandwidth / rate)),
      step(rms * std::sqrt(1.0 - decay * decay)) {
  // The real part of a complex value whose parts have the variance rms^2 turns with the carrier and keeps it.
  const double a = normals.next(), b = normals.next();
  amplitude = rms * std::complex<double>(a, b);
  if (defects.vibration_bandwidth == 0) amplitude *= std::sqrt(2.0) / std::hypot(a, b);
}

double ImuDefectModel::Vibration::next() {
  const double value = (amplitude * carrier).real();
  const double a = normals.next(), b = normals.next();
  amplitude = decay * amplitude + step * std::complex<double>(a, b);
  carrier *= turn;
  carrier /= std::abs(carrier);
  return value;
}

ImuDefectModel::ImuDefectModel(const ImuDefects& defects, double rate, std::uint64_t seed)
    : defects_(defects),
      interval_(1.0 / rate),
      gyro_error_(draw_error(defects.gyro, seed, kGyroScale, kGyroCross)),
      accel_error_(draw_error(defects.accel, seed, kAccelScale, kAccelCross)),
      jitter_(seed, kJitter),
      drop_bits_(hash_bits(hash_bits(seed) ^ hash_bits(~kDrop))) {
  if (!(rate > 0)) throw std::invalid_argument("the IMU's rate must be positive");
  check(defects);
  NormalStream g(seed, kGSensitivity);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) g_sensitivity_(row, column) = defects.g_sensitivity * g.next();
  for (std::uint64_t axis = 0; axis < 3; ++axis) {
    if (defects.gyro.vibration > 0)
      gyro_vibration_.emplace_back(defects, defects.gyro.vibration, rate, seed, kGyroVibration + axis);
    if (defects.accel.vibration > 0)
      accel_vibration_.emplace_back(defects, defects.accel.vibration, rate, seed, kAccelVibration + axis);
  }
}

Eigen::Vector3d ImuDefectModel::next_of(std::vector<Vibration>& axes) {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (std::size_t axis = 0; axis < axes.size(); ++axis) value[static_cast<Eigen::Index>(axis)] = axes[axis].next();
  return value;
}

ImuDefectModel::Reading ImuDefectModel::feel(const Reading& truth) {
  const Eigen::Vector3d shaking = next_of(accel_vibration_);
  const Eigen::Vector3d rate = truth.gyro + next_of(gyro_vibration_), force = truth.accel + shaking;
  return {rate + gyro_error_ * rate + g_sensitivity_ * force,
          force + accel_error_ * force + defects_.rectification * shaking.cwiseAbs2()};
}

ImuDefectModel::Reading ImuDefectModel::digitize(const Reading& reading) const {
  return {digitized(reading.gyro, defects_.gyro), digitized(reading.accel, defects_.accel)};
}

std::optional<TimeNs> ImuDefectModel::stamp(TimeNs true_time) {
  const double limit = kJitterLimit * interval_;
  const double jitter = std::clamp(defects_.stamp_jitter * jitter_.next(), -limit, limit);
  const bool lost = uniform_from_bits(hash_bits(drop_bits_ + sample_++)) < defects_.dropped_samples;
  if (lost) return std::nullopt;
  return true_time + to_ns(defects_.clock_offset + defects_.clock_drift * seconds_between(0, true_time) + jitter);
}

}  // namespace allan_lio
