// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/tuning_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "allan_lio/calib/tuning_text.h"

namespace allan_lio {
namespace {

constexpr std::size_t kShown = 10;  // settings of the table; all are in tuning.yaml

std::string number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string cell(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, " %11.*g", digits, value);
  return text;
}

bool has_truth(const ScoredSetting& scored) {
  return std::any_of(scored.trials.begin(), scored.trials.end(),
                     [](const TrialResult& result) { return !std::isnan(result.ate); });
}

/// Whether the data tell of any coefficient that one value is better than another.
bool any_told(const TuningOutcome& outcome) {
  return std::any_of(outcome.profiles.begin(), outcome.profiles.end(), [](const NoiseProfile& profile) {
    return profile.verdict != ProfileVerdict::kCannotBeTold && profile.verdict != ProfileVerdict::kNotJudged;
  });
}

/// " on the linear filter of 3 rounds with 9 runs", if so they were judged: all that were made of the bags tuned on.
std::string rounds_text(const TuningSession& session) {
  const std::size_t rounds = session.settings().report.rounds.size();
  if (rounds == 0) return "";
  const std::vector<std::uint32_t>& bags = session.settings().problem.bags;
  std::size_t runs = 0, diverged = 0;
  for (const auto& [trial, result] : session.rows()) {
    if (std::find(bags.begin(), bags.end(), trial.bag) == bags.end()) continue;  // held out
    ++runs;
    diverged += result.diverged ? 1 : 0;
  }
  return " on the linear filter of " + std::to_string(rounds) + " rounds with " + std::to_string(runs) + " runs" +
         (diverged > 0 ? ", " + std::to_string(diverged) + " of which diverged and were left out" : "");
}

std::string best_part(const TuningSession& session) {
  const ScoredSetting& best = session.best();
  const NoiseProblem& problem = session.evaluator().problem();
  const bool ate = problem.objective == TuningObjective::kAte;
  std::string text = "best: " + text_of(best.setting) + "\n  " + (ate ? "average ATE " : "objective ") +
                     number(best.objective, ate ? 4 : 8) + (ate ? " m" : " nats") + " of " +
                     std::to_string(session.evaluator().evaluations().size()) + " settings" + rounds_text(session) +
                     "; " + session.outcome().end + "\n";
  if (best.diverged > 0)
    text += "  WARNING: with it " + std::to_string(best.diverged) + " of " + std::to_string(best.trials.size()) +
            " runs still diverge: the trouble is not the noise's size, or lies outside of what was searched\n";
  for (const NoiseParameter p : problem.tuned) {
    const double k = multiplier(best.setting, p);
    if (k <= problem.lowest_k || k >= problem.highest_k)
      text += "  WARNING: " + std::string(name_of(p)) + " lies at the end of the box (--box)\n";
  }
  if (session.outcome().better_off_the_lists && any_told(session.outcome()))
    text += "  the profiles saw a better setting than any of the lists: try a finer list, or --search likelihood\n";
  if (!ate && problem.nll_scale < 1.0)
    text += "  successive innovations are not independent: each counts as " + number(problem.nll_scale, 3) +
            " of one in the objective and in the intervals (nll_scale)\n";
  return text;
}

std::string table_part(const TuningSession& session) {
  const NoiseProblem& problem = session.evaluator().problem();
  const std::vector<ScoredSetting>& all = session.evaluator().evaluations();
  std::vector<std::size_t> order = session.outcome().table;  // of a grid without its profiles
  if (order.empty()) {
    order.resize(all.size());
    std::iota(order.begin(), order.end(), 0);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return all[a].objective < all[b].objective; });
  const bool truth = has_truth(session.best());
  std::string text;
  for (const NoiseParameter p : problem.tuned)
    text += std::string(12 - 4, ' ') + (name_of(p) + std::string(4, ' ')).substr(0, 4);
  text += truth ? "     ATE max         min     average [m]" : "";
  text += "   objective    diverged\n";
  for (std::size_t i = 0; i < std::min(kShown, order.size()); ++i) {
    const ScoredSetting& scored = all[order[i]];
    for (const NoiseParameter p : problem.tuned) text += cell(multiplier(scored.setting, p), 5);
    const AteRange range = ate_range(problem, scored);
    if (truth) text += cell(range.max) + cell(range.min) + cell(range.average) + "    ";
    text += cell(scored.objective, 9) + "    " + std::to_string(scored.diverged) + " of " +
            std::to_string(scored.trials.size()) + "\n";
  }
  if (order.size() > kShown) text += "  (the best " + std::to_string(kShown) + "; all are in tuning.yaml)\n";
  return text;
}

std::string end_text(double value) {
  return value > 0.0 && std::isfinite(value) ? number(value, 3) : std::string("open");
}

std::string profile_part(const TuningSession& session) {
  std::string text;
  for (const NoiseProfile& profile : session.outcome().profiles) {
    text += std::string(name_of(profile.parameter)) + " " +
            number(multiplier(session.best().setting, profile.parameter)) + ": " + text_of(profile.verdict);
    if (is_likelihood(session.evaluator().problem().objective))
      text += "; 95 % " + end_text(profile.low) + " to " + end_text(profile.high) + ", by the curvature " +
              end_text(profile.curvature_low) + " to " + end_text(profile.curvature_high);
    if (!std::isnan(profile.scan_low))
      text += ", from scan to scan " + end_text(profile.scan_low) + " to " + end_text(profile.scan_high);
    text += "\n";
  }
  return text;
}

std::string change(const std::string& what, double before, double after, const std::string& unit) {
  if (!std::isfinite(before) && !std::isfinite(after)) return "";
  return ", " + what + " " + number(before, 6) + " -> " + number(after, 6) + unit;
}

double nis_per_dof(const TrialResult& r) { return r.nis_dof > 0 ? r.nis / static_cast<double>(r.nis_dof) : NAN; }
double horizon_nis_per_dof(const TrialResult& r) { return r.horizon_dof > 0.0 ? r.horizon_nis / r.horizon_dof : NAN; }

std::string run_text(const TrialResult& before, const TrialResult& after) {
  if (after.diverged) return ": diverges with the best setting";
  std::string text = before.diverged ? ": diverged before" : ":";
  text +=
      change("ATE", before.ate, after.ate, " m") + change("NLL", before.horizon_nll, after.horizon_nll, "") +
      change("NIS per degree of freedom over 3 to 30 s", horizon_nis_per_dof(before), horizon_nis_per_dof(after), "") +
      change("of the scans", nis_per_dof(before), nis_per_dof(after), "");
  return text.rfind(":,", 0) == 0 ? ":" + text.substr(2) : text;
}

std::string bags_part(const TuningSession& session) {
  const TuningReport& report = session.settings().report;
  std::string text;
  for (const BagComparison& c : report.comparisons) {
    const bool tuned_on = c.bag < report.bags.size();
    text += (tuned_on ? report.bags[c.bag].first : report.hold_out[c.bag - report.bags.size()].first + " (held out)") +
            run_text(c.before.result, c.after.result) + "\n";
  }
  if (session.held_out().empty()) return text;
  const NoiseProblem& problem = session.evaluator().problem();
  const ScoredSetting &before = session.held_out()[0], &after = session.held_out()[1];
  if (has_truth(after))
    text += "held out, all bags and runs: average ATE " + number(ate_range(problem, before).average) + " -> " +
            number(ate_range(problem, after).average) + " m\n";
  return text;
}

}  // namespace

std::string summary_of(const TuningSession& session) {
  return best_part(session) + "\n" + table_part(session) + "\n" + profile_part(session) + "\n" + bags_part(session);
}

}  // namespace allan_lio
