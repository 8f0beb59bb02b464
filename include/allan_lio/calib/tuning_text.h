// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/calib/noise_problem.h"

namespace allan_lio {

// What a user writes of a tuning problem, read. All throw std::invalid_argument with a sentence that quotes the text.

/// "a,b,c" at its commas, blanks taken away. Throws if a part is empty.
std::vector<std::string> parts_of(const std::string& text);

/// "k_gb,k_ab".
std::vector<NoiseParameter> parse_parameters(const std::string& text);

/// "1,10,50": one list for all; "k_gb=1,10;k_ab=1,3": a list for each of `parameters`, in their order whatever that of
/// the text; "paper": paper_grid().
std::vector<std::vector<double>> parse_grid(const std::string& text, const std::vector<NoiseParameter>& parameters);

/// "3": all of `tuned` at 3; "k_gb=10,k_ab=3": those. The others stay as they are in `start`.
NoiseSetting parse_start(const std::string& text, const std::vector<NoiseParameter>& tuned, NoiseSetting start);

/// "0.01,1000" into lowest_k and highest_k.
void parse_box(const std::string& text, NoiseProblem& problem);

/// "k_g 1, k_a 1, k_gb 10, k_ab 50, k_r 1".
std::string text_of(const NoiseSetting& setting);

}  // namespace allan_lio
