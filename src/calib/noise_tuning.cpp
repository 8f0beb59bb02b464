// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_tuning.h"

#include <algorithm>

namespace allan_lio {
namespace {

// What searches and profiles take of settings (noise_search.h, noise_profile.h), by the number of coefficients.
constexpr std::size_t kUsualSearch[] = {20, 35, 65, 95, 120}, kUsualProfile[] = {11, 45, 70, 100, 130};

constexpr double kNearby = 0.3;  // first step of ln k of a search that goes on from a former one's best

class Tuning {
 public:
  Tuning(NoiseEvaluator& evaluator, const TuningPlan& plan, const OnPhase& on_phase)
      : evaluator_(evaluator), plan_(plan), on_phase_(on_phase) {}

  TuningOutcome run() {
    search(usual(kUsualSearch));
    const bool lists = plan_.search == TuningSearch::kGrid || plan_.search == TuningSearch::kSequential;
    for (int round = 0; plan_.with_profiles && survived(outcome_.best); ++round) {
      begin("profiles", usual(kUsualProfile));
      const double lowest = objective(evaluator_.best());  // what bayes takes for the best may be another
      ProfileOptions options;
      options.kind = plan_.profile;
      outcome_.profiles = profile_noise(evaluator_, outcome_.best, options);
      if (objective(evaluator_.best()) >= lowest) break;
      outcome_.better_off_the_lists = lists;
      const std::size_t before = outcome_.best;
      if (lists || round == plan_.rounds) break;
      search(usual(kUsualSearch));
      if (outcome_.best == before) break;
    }
    return std::move(outcome_);
  }

 private:
  template <std::size_t n>
  std::size_t usual(const std::size_t (&counts)[n]) const {
    return counts[std::min(evaluator_.problem().tuned.size(), n) - 1];
  }
  double objective(std::size_t place) const { return evaluator_.evaluations()[place].objective; }
  bool survived(std::size_t place) const {
    const ScoredSetting& scored = evaluator_.evaluations()[place];
    return scored.diverged < scored.trials.size();
  }
  void begin(const std::string& phase, std::size_t settings) const {
    if (on_phase_) on_phase_(phase, settings);
  }

  void search(std::size_t usual_settings) {
    switch (plan_.search) {
      case TuningSearch::kGrid:
        return search_lists();
      case TuningSearch::kSequential:
        return search_in_turn();
      case TuningSearch::kLikelihood: {
        begin("search", evaluator_.evaluations().empty() ? usual_settings : usual_settings / 2);
        LikelihoodSearchOptions options;
        if (!evaluator_.evaluations().empty()) options.first_step = kNearby;
        if (plan_.budget > 0) options.most_settings = plan_.budget;
        return take(search_likelihood(evaluator_, options));
      }
      case TuningSearch::kBayes: {
        BayesSearchOptions options;
        options.seed = plan_.seed;
        if (plan_.budget > 0) options.most_settings = plan_.budget;
        begin("search", options.most_settings);
        return take(search_bayes(evaluator_, options));
      }
    }
  }

  void search_lists() {
    std::size_t settings = 1;
    for (std::size_t i = 0; i < evaluator_.problem().tuned.size(); ++i)
      settings *= plan_.grid.empty() ? 0 : plan_.grid[std::min(i, plan_.grid.size() - 1)].size();
    begin("grid", settings);
    const GridResult result = search_grid(evaluator_, plan_.grid);
    outcome_.table = result.table;
    outcome_.best = result.best;
    outcome_.end = survived(result.best) ? "all of the grid was tried" : "every run of the grid diverged";
  }

  void search_in_turn() {
    std::size_t settings = 1;
    for (std::size_t i = 0; i < plan_.order.size(); ++i)
      settings += plan_.grid.empty() ? 0 : plan_.grid[std::min(i, plan_.grid.size() - 1)].size();
    begin("one after the other", settings);
    outcome_.steps = search_sequentially(evaluator_, plan_.order, plan_.grid);
    outcome_.best = outcome_.steps.back().best;
    outcome_.end = survived(outcome_.best) ? "every coefficient had its turn" : "every run diverged";
  }

  void take(const SearchResult& result) {
    outcome_.best = result.best;
    outcome_.end = result.end == SearchEnd::kConverged     ? "converged"
                   : result.end == SearchEnd::kBudgetSpent ? "the budget of settings was spent"
                                                           : "every run of every setting diverged";
  }

  NoiseEvaluator& evaluator_;
  const TuningPlan& plan_;
  const OnPhase& on_phase_;
  TuningOutcome outcome_;
};

}  // namespace

const char* name_of(TuningSearch search) {
  switch (search) {
    case TuningSearch::kGrid:
      return "grid";
    case TuningSearch::kSequential:
      return "sequential";
    case TuningSearch::kLikelihood:
      return "likelihood";
    case TuningSearch::kBayes:
      break;
  }
  return "bayes";
}

TuningOutcome tune(NoiseEvaluator& evaluator, const TuningPlan& plan, const OnPhase& on_phase) {
  return Tuning(evaluator, plan, on_phase).run();
}

std::string text_of(ProfileVerdict verdict) {
  switch (verdict) {
    case ProfileVerdict::kTold:
      return "told by this data";
    case ProfileVerdict::kOnlyUpperBound:
      return "only bounded above by this data: anything smaller does as well";
    case ProfileVerdict::kOnlyLowerBound:
      return "only bounded below by this data: anything larger does as well";
    case ProfileVerdict::kNotJudged:
      return "not judged: one run a setting does not tell chance (--runs)";
    case ProfileVerdict::kCannotBeTold:
      break;
  }
  return "cannot be told from this data";
}

}  // namespace allan_lio
