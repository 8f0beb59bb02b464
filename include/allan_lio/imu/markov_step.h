// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace allan_lio {

/// A first-order Gauss-Markov process of steady-state variance 1 over a step of length h, exactly: from the value at
/// the begin to the value at the end, decay * value + noise, and to the mean over the step, mean_gain * value + noise.
/// From b' = -b/T + w by integration (Gelb 1974, section 3.6).
struct MarkovStep {
  double decay = 1.0;           ///< e^-a, a = h/T
  double mean_gain = 1.0;       ///< (1 - e^-a)/a
  double value_variance = 0.0;  ///< of the end's noise, 1 - e^-2a
  double covariance = 0.0;      ///< of the two noises, (1 - e^-a)^2/a
  double mean_variance = 0.0;   ///< of the mean's noise, (2a - 3 + 4 e^-a - e^-2a)/a^2
};

/// `a` = h/T > 0.
MarkovStep markov_step(double a);

}  // namespace allan_lio
