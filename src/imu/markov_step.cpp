// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/markov_step.h"

#include <cmath>

namespace allan_lio {

MarkovStep markov_step(double a) {
  constexpr double kSmall = 0.05;
  const double fall = -std::expm1(-a);  // 1 - e^-a
  MarkovStep step;
  step.decay = std::exp(-a);
  step.mean_gain = fall / a;
  step.value_variance = -std::expm1(-2.0 * a);
  step.covariance = fall * fall / a;
  // Where the terms cancel, their series -(-1)^n (2^n - 4) a^(n-2)/n!, n >= 3.
  step.mean_variance = a < kSmall
                           ? a * (2.0 / 3.0 - a * (0.5 - a * (7.0 / 30.0 - a * (1.0 / 12.0 - a * (31.0 / 1260.0)))))
                           : (2.0 * a - 3.0 + 4.0 * step.decay - step.decay * step.decay) / (a * a);
  return step;
}

}  // namespace allan_lio
