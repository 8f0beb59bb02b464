// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

// A bias in two parts: a constant that is unknown at the start (the turn-on bias), and a first-order Gauss-Markov
// process about it (paper, `gmmodel`): b' = -(b - mean)/T + w, mean' = 0.

/// y (-) x of the inertial state and the means.
InertialVector inertial_minus(const NavState& y, const NavState& x);

/// `transition` with what the means' errors make of the biases in the same time, I - Phi_bb. (What they make of
/// attitude, velocity and position within it is left out: of the bias's own effect the part t/(2T), for a scan less
/// than a hundredth.)
InertialMatrix with_bias_means(const NavMatrix& transition);

/// The same on an error and on a covariance, which are carried over the interval.
void carry(const NavMatrix& transition, InertialVector& error);
void carry(const NavMatrix& transition, InertialMatrix& covariance);

/// Tells apart what is known at the start of the biases' sums: `spec` gives the turn-on biases, about `state`'s means
/// as they are here, `noise` the process, in its steady state. Sets the means, and their covariance with all else. The
/// means of axes without a correlation time stay, and are known.
void split_biases(const NoiseSpec& spec, const ImuNoise& noise, NavState& state, InertialMatrix& covariance);

}  // namespace allan_lio
