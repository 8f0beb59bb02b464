// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_gate.h"

#include <algorithm>

namespace allan_lio {
namespace {

constexpr double kAbsurdAccel = 50.0 * 9.80665;  // [m/s^2]
constexpr double kAbsurdGyro = 100.0;            // [rad/s]

}  // namespace

bool is_sane(const ImuSample& s, double accel_scale) {  // false for NaN and infinity too
  return accel_scale * s.accel.norm() <= kAbsurdAccel && s.gyro.norm() <= kAbsurdGyro;
}

ImuGate::Passed ImuGate::pass(const ImuSample& sample) {
  Passed passed;
  if (!is_sane(sample, accel_scale_)) {
    passed.absurd = true;
    return passed;
  }
  if (suspect_) {
    if (sample.stamp > suspect_->stamp) passed.kept_back = suspect_;
    passed.wrong_stamp = !passed.kept_back;
    suspect_.reset();
  } else if (newest_ && seconds_between(*newest_, sample.stamp) > kSuspiciousLeap) {
    suspect_ = sample;
    return passed;
  }
  passed.sample = sample;
  newest_ = newest_ ? std::max(*newest_, sample.stamp) : sample.stamp;
  return passed;
}

bool ImuGate::set_accel_scale(double scale) {
  accel_scale_ = scale;
  if (!suspect_ || is_sane(*suspect_, scale)) return false;
  suspect_.reset();
  return true;
}

std::optional<ImuSample> ImuGate::release() {
  const std::optional<ImuSample> last = suspect_;
  suspect_.reset();
  return last;
}

}  // namespace allan_lio
