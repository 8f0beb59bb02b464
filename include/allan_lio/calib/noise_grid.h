// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "allan_lio/calib/noise_evaluator.h"

namespace allan_lio {

/// {10, 15, 20, 25, 30, 40, 45, 50}: the paper's values of k_gb and of k_ab.
std::vector<double> paper_grid();

/// Which settings of the evaluator a search looked at, and the best of them.
struct GridResult {
  std::vector<std::size_t> table;  ///< places in NoiseEvaluator::evaluations(), the last coefficient varying fastest
  std::size_t best = 0;            ///< likewise; of equal ones the first in the table
};

/// Every combination, in one batch. `values` holds a list per tuned coefficient in their order, or one list for all.
/// Throws std::invalid_argument if there are none or a wrong number of lists, or a value outside the box.
GridResult search_grid(NoiseEvaluator& evaluator, const std::vector<std::vector<double>>& values);

/// One coefficient's turn.
struct SequentialStep {
  NoiseParameter parameter = NoiseParameter::kKa;
  std::vector<std::size_t> table;  ///< the setting before, then those with the values of the list
  std::size_t best = 0;
};

/// k_a, k_g, k_ab, k_gb (paper, section on OpenVINS) and then k_r, as far as they are tuned.
std::vector<NoiseParameter> paper_order(const NoiseProblem& problem);

/// One coefficient after the other, the others held: the best value is kept, which may be the one before. `values`
/// holds a list per coefficient in the order of `order`, or one list for all. Throws as search_grid, and if `order` is
/// no permutation of the tuned coefficients.
std::vector<SequentialStep> search_sequentially(NoiseEvaluator& evaluator, const std::vector<NoiseParameter>& order,
                                                const std::vector<std::vector<double>>& values);

}  // namespace allan_lio
