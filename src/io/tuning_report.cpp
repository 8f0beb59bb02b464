// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/tuning_report.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "allan_lio/io/number_text.h"
#include "allan_lio/io/yaml_quoted.h"

namespace allan_lio {
namespace {

constexpr NoiseParameter kAll[] = {NoiseParameter::kKg, NoiseParameter::kKa, NoiseParameter::kKgb, NoiseParameter::kKab,
                                   NoiseParameter::kKr};

std::string real(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return number_text(value);
}

std::string setting_map(const NoiseSetting& setting) {
  std::string text;
  for (const NoiseParameter p : kAll)
    text += (text.empty() ? "{" : ", ") + std::string(name_of(p)) + ": " + real(multiplier(setting, p));
  return text + "}";
}

/// Both ends, null where the interval is open.
std::string interval(double low, double high) {
  return "[" + (low > 0.0 ? real(low) : "null") + ", " + (std::isfinite(high) ? real(high) : "null") + "]";
}

std::string bag_list(const NamedTexts& bags) {
  std::string text;
  for (const auto& [name, hash] : bags)
    text += "\n    - {name: " + yaml_quoted(name) + ", hash: " + yaml_quoted(hash) + "}";
  return text.empty() ? " []" : text;
}

std::string map_of(const NamedTexts& entries) {
  std::string text;
  for (const auto& [name, value] : entries) text += "\n    " + yaml_quoted(name) + ": " + yaml_quoted(value);
  return text.empty() ? " {}" : text;
}

std::string parameter_list(const std::vector<NoiseParameter>& parameters) {
  std::string text;
  for (const NoiseParameter p : parameters) text += (text.empty() ? "" : ", ") + std::string(name_of(p));
  return "[" + text + "]";
}

std::string problem_part(const TuningReport& report, const NoiseProblem& problem) {
  return "problem:\n  bags:" + bag_list(report.bags) + "\n  hold_out:" + bag_list(report.hold_out) +
         "\n  config: " + yaml_quoted(report.config) + "\n  parameters: " + parameter_list(problem.tuned) +
         "\n  search: " + name_of(report.search) + "\n  objective: " + name_of(problem.objective) +
         "\n  runs: " + std::to_string(problem.runs) + "\n  seed: " + std::to_string(report.seed) +
         "\n  start: " + setting_map(problem.start) + "\n  box: " + interval(problem.lowest_k, problem.highest_k) +
         "\n  prior_sigma: " + real(problem.prior_sigma) + "\n  nll_scale: " + real(problem.nll_scale) +
         "\n  command: " + yaml_quoted(report.command) + "\n  versions:" + map_of(report.versions) +
         "\n  hashes:" + map_of(report.hashes) + "\n";
}

std::string profile_part(const NoiseEvaluator& evaluator, const NoiseProfile& profile) {
  std::string points;
  for (const ProfilePoint& point : profile.points) {
    const ScoredSetting& scored = evaluator.evaluations()[point.evaluation];
    points += (points.empty() ? "[" : ", [") + real(point.k) + ", " + real(scored.objective - scored.prior) + "]";
  }
  std::string text = "  - parameter: " + std::string(name_of(profile.parameter)) + "\n    points: [" + points + "]\n";
  if (is_likelihood(evaluator.problem().objective))
    text += "    interval: " + interval(profile.low, profile.high) +
            "\n    curvature_interval: " + interval(profile.curvature_low, profile.curvature_high) + "\n";
  if (!std::isnan(profile.scan_low))
    text += "    scan_interval: " + interval(profile.scan_low, profile.scan_high) + "\n";
  return text + "    verdict: " + yaml_quoted(text_of(profile.verdict)) + "\n";
}

std::string round_part(const LinearRound& round) {
  const LidarErrors& e = round.errors;
  return "  - {at: " + setting_map(round.at) + ", found: " + setting_map(round.found) +
         ", lidar_errors: {white: " + real(e.white) + ", view: " + real(e.view) +
         ", drift_rotation: " + real(e.drift_rotation) + ", drift_position: " + real(e.drift_position) +
         "}, objective: " + real(round.objective) + ", runs: " + std::to_string(round.runs) +
         ", diverged: " + std::to_string(round.diverged) + "}\n";
}

std::string run_part(const ComparedRun& run) {
  const TrialResult& r = run.result;
  std::string text = "{";
  if (!run.trajectory.empty()) text += "trajectory: " + yaml_quoted(run.trajectory) + ", ";
  if (!std::isnan(r.ate)) text += "ate: " + real(r.ate) + ", ";
  return text + "nll: " + real(r.nll) + ", nis: " + real(r.nis) + ", dof: " + std::to_string(r.nis_dof) +
         ", horizon_nll: " + real(r.horizon_nll) + ", horizon_nis: " + real(r.horizon_nis) +
         ", horizon_dof: " + real(r.horizon_dof) + ", diverged: " + (r.diverged ? "true" : "false") + "}";
}

std::string comparison_part(const TuningReport& report) {
  std::string text = "before_after:\n  before: " + setting_map(report.before) + "\n  bags:";
  for (const BagComparison& c : report.comparisons) {
    text += "\n    - bag: " + std::to_string(c.bag);
    if (!c.reference.empty()) text += "\n      reference: " + yaml_quoted(c.reference);
    text += "\n      before: " + run_part(c.before) + "\n      after: " + run_part(c.after);
  }
  return text + (report.comparisons.empty() ? " []\n" : "\n");
}

/// The order of the rows.
auto rank_of(const TrialRow& row) {
  const NoiseSetting& s = row.first.setting;
  return std::make_tuple(row.first.bag, s.imu.k_g, s.imu.k_a, s.imu.k_gb, s.imu.k_ab, s.k_r, row.first.run);
}

std::string cell(double value) { return std::isfinite(value) ? number_text(value) : std::isnan(value) ? "nan" : "inf"; }

std::string line_of(const NoiseTrial& trial, const TrialResult& r) {
  std::string text = std::to_string(trial.bag) + "," + std::to_string(trial.run);
  for (const NoiseParameter p : kAll) text += "," + cell(multiplier(trial.setting, p));
  for (const double value : {r.ate, r.end_error, r.nll, r.nis}) text += "," + cell(value);
  text += "," + std::to_string(r.nis_dof);
  for (const double value : {r.horizon_nll, r.horizon_nis, r.horizon_dof, r.horizon_share}) text += "," + cell(value);
  return text + "," + std::to_string(r.scans) + (r.diverged ? ",1\n" : ",0\n");
}

}  // namespace

std::string tuning_yaml(const TuningReport& report, const NoiseEvaluator& evaluator, const TuningOutcome& outcome) {
  const ScoredSetting& best = evaluator.evaluations()[outcome.best];
  std::string text = problem_part(report, evaluator.problem()) + "best: {setting: " + setting_map(best.setting) +
                     ", objective: " + real(best.objective) + ", end: " + yaml_quoted(outcome.end) +
                     "}\nevaluations:\n";
  for (const ScoredSetting& scored : evaluator.evaluations())
    text += "  - {setting: " + setting_map(scored.setting) + ", objective: " + real(scored.objective) + "}\n";
  text += report.rounds.empty() ? "rounds: []\n" : "rounds:\n";
  for (const LinearRound& round : report.rounds) text += round_part(round);
  text += outcome.profiles.empty() ? "profiles: []\n" : "profiles:\n";
  for (const NoiseProfile& profile : outcome.profiles) text += profile_part(evaluator, profile);
  return text + comparison_part(report);
}

std::string setting_yaml(const NoiseSetting& setting, const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  text += "imu:\n";
  for (const NoiseParameter p : kAll) {
    if (p == NoiseParameter::kKr) text += "lidar:\n";
    text += "  " + std::string(name_of(p)) + ": " + number_text(multiplier(setting, p)) + "\n";
  }
  return text;
}

std::string trials_csv(std::vector<TrialRow> rows) {
  std::sort(rows.begin(), rows.end(), [](const TrialRow& a, const TrialRow& b) { return rank_of(a) < rank_of(b); });
  const auto same = [](const TrialRow& a, const TrialRow& b) { return rank_of(a) == rank_of(b); };
  rows.erase(std::unique(rows.begin(), rows.end(), same), rows.end());
  std::string text =
      "bag,run,k_g,k_a,k_gb,k_ab,k_r,ate,end_error,nll,nis,nis_dof,horizon_nll,horizon_nis,horizon_dof,"
      "horizon_share,scans,diverged\n";
  for (const auto& [trial, result] : rows) text += line_of(trial, result);
  return text;
}

}  // namespace allan_lio
