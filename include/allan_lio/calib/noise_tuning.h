// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_grid.h"
#include "allan_lio/calib/noise_profile.h"
#include "allan_lio/calib/noise_search.h"

namespace allan_lio {

enum class TuningSearch { kGrid, kSequential, kLikelihood, kBayes };

/// "grid", "sequential", "likelihood", "bayes".
const char* name_of(TuningSearch search);

/// How a problem is searched and what is asked about the result.
struct TuningPlan {
  TuningSearch search = TuningSearch::kLikelihood;
  std::vector<std::vector<double>> grid;  ///< kGrid, kSequential: as search_grid and search_sequentially take it
  std::vector<NoiseParameter> order;      ///< kSequential
  std::size_t budget = 0;                 ///< kLikelihood, kBayes: settings at most; 0: the search's own
  std::uint64_t seed = 1;                 ///< kBayes
  /// kLikelihood, of an objective without truth: run the filter anew with every setting that is tried, instead of
  /// judging most of them on linear runs (LinearTuning). What tune() does; TuningSession looks at it.
  bool rerun = false;
  bool with_profiles = true;
  ProfileKind profile = ProfileKind::kFollowed;
  int rounds = 2;  ///< in which a better setting that the profiles find is searched on from; not for lists
};

/// What came of it; places are those of NoiseEvaluator::evaluations().
struct TuningOutcome {
  std::size_t best = 0;
  std::string end;                     ///< a clause on how the search ended: "converged"
  std::vector<std::size_t> table;      ///< kGrid
  std::vector<SequentialStep> steps;   ///< kSequential
  std::vector<NoiseProfile> profiles;  ///< about the best; none if no run survived
  bool better_off_the_lists = false;   ///< kGrid, kSequential: the profiles saw a setting better than the best
};

/// Told what begins and how many settings it will about take; each is evaluated once.
using OnPhase = std::function<void(const std::string& phase, std::size_t settings)>;

/// Searches, draws the profiles about the best, and where they find a better one searches on from there. What is known
/// to the evaluator is used. Throws as the searches do; `on_phase` may be empty.
TuningOutcome tune(NoiseEvaluator& evaluator, const TuningPlan& plan, const OnPhase& on_phase);

/// "told", "cannot be told from this data" and so on, in a clause.
std::string text_of(ProfileVerdict verdict);

}  // namespace allan_lio
