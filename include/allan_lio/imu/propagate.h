// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/imu/discretize.h"
#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/imu/nav_state.h"

namespace allan_lio {

/// The mean reading of the interval between two samples, the state's biases taken off.
ImuInterval mean_interval(const NavState& state, const ImuSample& from, const ImuSample& to);

/// Moves the mean over the interval, exactly for constant rate and specific force:
/// R <- R Exp(w dt), v <- v + g dt + R Gamma_1 a dt, p <- p + v dt + g dt^2/2 + R Gamma_2 a dt^2;
/// Gauss-Markov biases decay to their means by exp(-dt/T). Advances the stamp by dt rounded to nanoseconds.
NavState propagate_mean(const NavState& state, const ImuInterval& interval, const ImuNoise& noise);

}  // namespace allan_lio
