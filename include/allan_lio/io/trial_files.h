// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

/// Trials and their results as files that a process on another machine reads: CSV under a first line that names the
/// format and counts the rows, so that a file that was cut off is found out. Numbers come back to the same bits (NaN
/// as NaN). Files are written in one piece: who sees one sees all of it. Mistakes are std::runtime_errors that name
/// file and line.
void write_trials(const std::string& path, const std::vector<NoiseTrial>& trials);
std::vector<NoiseTrial> read_trials(const std::string& path);

void write_results(const std::string& path, const std::vector<TrialResult>& results);
std::vector<TrialResult> read_results(const std::string& path);

}  // namespace allan_lio
