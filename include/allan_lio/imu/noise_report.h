// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/io/parameter_visitor.h"

namespace allan_lio {

/// The noise in force, for people to check: S with what it was made of (N, sigma_b, T_b, k), told also as random walk
/// and as the deviations and covariances of single samples at `rate` [Hz], the numbers that other packages take.
/// One line each.
std::vector<std::string> describe_noise(const NoiseSpec& spec, const NoiseScale& scale, double rate);

/// "0.00245 rad/s", or the three axes where they differ by more than rounding: "(1, 2, 3)e-5 rad/s" is spelled
/// "1e-05, 2e-05, 3e-05 rad/s". Four significant digits.
std::string axes_text(const Eigen::Vector3d& value, const std::string& unit);

/// The same in another unit than SI, `value` being SI: axes_text_in(value, "deg/sqrt(h)", Dimension::kGyroWhiteNoise).
std::string axes_text_in(const Eigen::Vector3d& value, const std::string& unit, Dimension dimension);

}  // namespace allan_lio
