// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/io/config_source.h"

namespace allan_lio {

/// A bias is told in one of three ways (imu_noise.h). Throws ConfigError unless for gyro and accelerometer exactly one
/// of bias_instability, bias_random_walk and bias_sigma is given, with one of bias_time and bias_flat_time where it
/// needs one. The sentence names the keys and their origins.
void check_noise_keys(const ConfigSource& source);

/// Takes out of `base` what `over` says in another way: the other bias figures and their times, the other one of
/// bias_time and bias_flat_time, and the rate of a quantity that gets a new unit.
void drop_replaced_noise(ConfigSource& base, const ConfigSource& over);

}  // namespace allan_lio
