// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/io/noise_lint.h"

namespace allan_lio {

/// The slip in the white noise that explains the file best, if one does.
std::vector<LintFinding> find_white_slip(const NoiseFile& file, const std::vector<KnownImu>& known);

/// Slips in the bias figures alone, judged against the IMU whose white noise the file has.
std::vector<LintFinding> find_bias_slips(const NoiseFile& file, const std::vector<KnownImu>& known);

/// FAST-LIO2's and Point-LIO's b_gyr_cov and b_acc_cov: left alone far more often than mistaken for anything.
bool is_shipped_bias(const NoiseFigure& figure);

/// The file's bias with the known IMU's T_b where it tells a level without one.
NoiseSpec with_bias_time_of(NoiseSpec spec, const NoiseSpec& known);

/// "129", "26.9" as "27", "12.5": as many digits as a multiplier deserves.
std::string k_text(double k);

/// Four digits, with a point whatever the locale.
std::string short_text(double value);

}  // namespace allan_lio
