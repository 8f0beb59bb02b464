// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// The MTi-600's figures (theory section 1) with the turn-on biases of config/imu/mti600.yaml, in SI.
inline NoiseSpec mti600_spec() {
  constexpr double kDeg = M_PI / 180.0, kMicroG = 9.80665e-6;
  NoiseSpec s;
  s.gyro.white.setConstant(0.42 * kDeg / 60.0);
  s.accel.white.setConstant(60.0 * kMicroG);
  s.gyro.bias_instability.setConstant(8.0 * kDeg / 3600.0);
  s.accel.bias_instability.setConstant(10.0 * kMicroG);
  s.gyro.bias_time.setConstant(31.7);
  s.accel.bias_time << 63.5, 63.5, 31.7;
  s.gyro.turn_on_bias.setConstant(0.2 * kDeg);
  s.accel.turn_on_bias.setConstant(5e3 * kMicroG);
  return s;
}

}  // namespace allan_lio
