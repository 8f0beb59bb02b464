// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "allan_lio/calib/noise_evaluator.h"

namespace allan_lio {

enum class SearchEnd {
  kConverged,    ///< to the tolerance
  kBudgetSpent,  ///< as many settings as allowed
  kAllDiverged,  ///< no setting was found at which any run survived
};

/// All that a search looked at is in the evaluator, in its order.
struct SearchResult {
  std::size_t best = 0;  ///< place in NoiseEvaluator::evaluations()
  SearchEnd end = SearchEnd::kConverged;
};

struct LikelihoodSearchOptions {
  double first_step = 1.0986122886681098;  ///< of ln k: a factor of three
  double tolerance = 0.02;                 ///< of ln k
  std::size_t most_settings = 150;         ///< evaluated by this search; those known before are free
};

/// The minimum of the objective over ln k by BOBYQA (Powell 2009, NLopt), started anew with smaller steps until it
/// comes to rest. It sets out from the best of the problem's start and of all k alike at 0.1 to 30, one batch, so that
/// a bad start does not hold it; where all of those diverge, from points spread over the box. The objective is told to
/// it on a scale that is logarithmic far above the best of the scan, so that a cliff does not spoil its quadratic
/// model. Of BOBYQA, SBPLX, COBYLA and Nelder-Mead the first needs about half of the settings on variance
/// components, smooth, rugged or with a cliff: some 35 for two coefficients, 65 for three, 95 for four, 120 for five.
SearchResult search_likelihood(NoiseEvaluator& evaluator, const LikelihoodSearchOptions& options = {});

struct BayesSearchOptions {
  std::size_t most_settings = 40;  ///< evaluated by this search; those known before are free and used
  std::uint64_t seed = 1;          ///< of the space-filling start and of the candidates
};

/// Bayesian optimisation (Jones, Schonlau and Welch 1998): a Gaussian process over ln k, fitted to the evaluations on
/// a logarithmic scale above the best, and next the setting of the largest expected improvement. The best is the
/// evaluated setting with the lowest mean of the process, which on a rugged objective is not the luckiest run. For one
/// or two coefficients: of more, the likelihood search comes nearer in as many settings. Same seed, same settings.
SearchResult search_bayes(NoiseEvaluator& evaluator, const BayesSearchOptions& options = {});

}  // namespace allan_lio
