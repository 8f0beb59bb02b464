// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/io/imu_yaml.h"
#include "allan_lio/io/noise_lint.h"

namespace allan_lio {

/// What `imu_noise lint` prints: every figure in SI and in data-sheet units, the implied k's against every known IMU,
/// the findings.
std::string lint_text(const LintReport& report);

/// What `imu_noise show` prints: the same noise as Allan figures, random walks, Gauss-Markov deviations and covariances
/// of samples. `bias_time` [s] stands in where the noise has no T_b; 0: none.
std::string show_text(const NoiseFile& file, double bias_time);

}  // namespace allan_lio
