// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_arguments.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include "allan_lio/calib/tuning_text.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument(what);
}

/// What `read` makes of an option's text; mistakes are told with the option's name.
template <class Read>
auto of_option(const char* option, Read read) {
  try {
    return read();
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string(option) + ": " + error.what());
  }
}

void check_bags(const TuningArguments& a) {
  require(a.bags.empty() != a.suite.empty(), "give either --bag or --suite");
  require(!a.config.empty() || !a.suite.empty(), "--config is needed: what the bags are read and run with");
  require(a.references.empty() || a.references.size() == a.bags.size(),
          "there are " + std::to_string(a.bags.size()) + " bags and " + std::to_string(a.references.size()) +
              " references: give one for each --bag, in their order");
  require(a.hold_out_references.empty() || a.hold_out_references.size() == a.hold_out.size(),
          "give one --hold-out-reference for each --hold-out, in their order");
  require(a.hold_out.empty() || !a.config.empty(), "--hold-out needs --config");
  require(!a.suite.empty() || (a.seeds + a.only + a.hold_out_seeds).empty(),
          "--seeds, --only and --hold-out-seeds need --suite");
}

void check_search(const TuningArguments& a) {
  const bool lists = a.search == "grid" || a.search == "sequential";
  require(!lists || !a.grid.empty(), "--search " + a.search + " needs --grid: the values to try, or 'paper'");
  require(lists || a.grid.empty(), "--grid is for --search grid and sequential");
  require(a.order.empty() || a.search == "sequential", "--order is for --search sequential");
  require(!a.rerun || a.search == "likelihood", "--rerun is for --search likelihood: the others run every setting");
  require(!lists || a.budget == 0, "--budget is for --search likelihood and bayes");
  require(is_likelihood(objective_of(a)) || !a.suite.empty() || !a.references.empty(),
          "the objective ate needs the bags' ground truth (--reference); without it take --objective nll");
  require(is_likelihood(objective_of(a)) || a.profile.empty() || a.profile == "slice" || a.profile == "none",
          "of the objective ate there are slices only: --profile slice or none");
}

ProfileKind profile_of(const TuningArguments& a) {
  if (a.profile == "slice" || !is_likelihood(objective_of(a))) return ProfileKind::kSlice;
  return a.profile == "reoptimised" ? ProfileKind::kReoptimised : ProfileKind::kFollowed;
}

}  // namespace

void check_arguments(const TuningArguments& a) {
  require(!a.out.empty(), "--out is needed: the directory for the results");
  require(!a.parameters.empty(), "--params is needed: which of k_g, k_a, k_gb, k_ab and k_r are tuned");
  check_bags(a);
  check_search(a);
}

TuningSearch search_of(const TuningArguments& a) {
  for (const TuningSearch search :
       {TuningSearch::kGrid, TuningSearch::kSequential, TuningSearch::kLikelihood, TuningSearch::kBayes})
    if (a.search == name_of(search)) return search;
  throw std::invalid_argument("--search: '" + a.search + "' is not grid, sequential, likelihood or bayes");
}

TuningObjective objective_of(const TuningArguments& a) {
  for (const TuningObjective objective : {TuningObjective::kAte, TuningObjective::kNll, TuningObjective::kScanNll})
    if (a.objective == name_of(objective)) return objective;
  require(a.objective.empty(), "--objective: '" + a.objective + "' is not ate, nll or scan_nll");
  const bool lists = a.search == "grid" || a.search == "sequential";
  const bool bayes_with_truth = a.search == "bayes" && (!a.references.empty() || !a.suite.empty());
  return lists || bayes_with_truth ? TuningObjective::kAte : TuningObjective::kNll;
}

NoiseProblem problem_of(const TuningArguments& a, const NoiseSetting& configured, std::uint32_t bags) {
  NoiseProblem problem;
  problem.bags.resize(bags);
  std::iota(problem.bags.begin(), problem.bags.end(), 0U);
  problem.runs = a.runs;
  problem.objective = objective_of(a);
  problem.tuned = of_option("--params", [&] { return parse_parameters(a.parameters); });
  problem.start = configured;
  if (!a.start.empty())
    problem.start = of_option("--start", [&] { return parse_start(a.start, problem.tuned, configured); });
  if (!a.box.empty()) of_option("--box", [&] { return parse_box(a.box, problem); });
  if (a.prior_sigma > 0.0) problem.prior_sigma = a.prior_sigma;
  if (a.nll_scale != "auto")
    require(parse_number(a.nll_scale, &problem.nll_scale) && problem.nll_scale > 0.0,
            "--nll-scale: '" + a.nll_scale + "' is neither auto nor a positive number");
  check_problem(problem);
  return problem;
}

TuningPlan plan_of(const TuningArguments& a, const NoiseProblem& problem) {
  TuningPlan plan;
  plan.search = search_of(a);
  plan.order = paper_order(problem);
  if (!a.order.empty()) plan.order = of_option("--order", [&] { return parse_parameters(a.order); });
  require(std::is_permutation(plan.order.begin(), plan.order.end(), problem.tuned.begin(), problem.tuned.end()),
          "--order: must name each coefficient of --params once");
  const bool in_turn = plan.search == TuningSearch::kSequential;
  if (!a.grid.empty())
    plan.grid = of_option("--grid", [&] { return parse_grid(a.grid, in_turn ? plan.order : problem.tuned); });
  for (const std::vector<double>& list : plan.grid)
    for (const double k : list)
      require(k >= problem.lowest_k && k <= problem.highest_k,
              "--grid: " + number_text(k) + " lies outside of the box " + number_text(problem.lowest_k) + " to " +
                  number_text(problem.highest_k) + " (--box)");
  plan.budget = static_cast<std::size_t>(a.budget);
  plan.seed = a.seed;
  plan.rerun = a.rerun;
  plan.with_profiles = a.profile != "none";
  plan.profile = profile_of(a);
  return plan;
}

}  // namespace allan_lio
