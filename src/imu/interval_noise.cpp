// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/interval_noise.h"

#include <algorithm>

namespace allan_lio {
namespace {

constexpr double kSaturatedPart = 0.2;  // 1 sigma of a saturated reading, of the full scale

// Where samples are missing: 1 sigma of what the readings between them may differ from the line, and for how long they
// do so in one direction. Walking or driving, not flying aerobatics.
constexpr double kUnknownRate = 0.5;   // [rad/s]
constexpr double kUnknownAccel = 2.0;  // [m/s^2]
constexpr double kUnknownTime = 0.5;   // [s]

double square(double x) { return x * x; }

bool reaches(double range, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return std::max(from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff()) >= range;
}

}  // namespace

bool is_saturated(const ImuRange& range, const ImuSample& from, const ImuSample& to) {
  return reaches(range.gyro, from.gyro, to.gyro) || reaches(range.accel, from.accel, to.accel);
}

ImuNoise noise_between(const ImuNoise& noise, const ImuRange& range, const ImuSample& from, const ImuSample& to,
                       double spacing) {
  const double dt = seconds_between(from.stamp, to.stamp);
  ImuNoise inflated = noise;
  if (spacing > kImuGap) {
    const double together = std::min(spacing, kUnknownTime);
    inflated.gyro_psd.array() += square(kUnknownRate) * together;
    inflated.accel_psd.array() += square(kUnknownAccel) * together;
  }
  if (reaches(range.gyro, from.gyro, to.gyro)) inflated.gyro_psd.array() += square(kSaturatedPart * range.gyro) * dt;
  if (reaches(range.accel, from.accel, to.accel))
    inflated.accel_psd.array() += square(kSaturatedPart * range.accel) * dt;
  return inflated;
}

}  // namespace allan_lio
