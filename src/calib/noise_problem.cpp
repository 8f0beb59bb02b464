// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_problem.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr NoiseParameter kAll[] = {NoiseParameter::kKg, NoiseParameter::kKa, NoiseParameter::kKgb, NoiseParameter::kKab,
                                   NoiseParameter::kKr};

void require(bool good, const std::string& what) {
  if (!good) throw std::invalid_argument("tuning: " + what);
}

/// To five digits.
double rounded(double k) {
  const double unit = std::pow(10.0, 4.0 - std::floor(std::log10(k)));
  return std::round(k * unit) / unit;
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

const char* name_of(NoiseParameter parameter) {
  switch (parameter) {
    case NoiseParameter::kKg:
      return "k_g";
    case NoiseParameter::kKa:
      return "k_a";
    case NoiseParameter::kKgb:
      return "k_gb";
    case NoiseParameter::kKab:
      return "k_ab";
    case NoiseParameter::kKr:
      break;
  }
  return "k_r";
}

NoiseParameter noise_parameter(const std::string& name) {
  for (const NoiseParameter parameter : kAll)
    if (name == name_of(parameter)) return parameter;
  throw std::invalid_argument("tuning: there is no coefficient '" + name + "': they are k_g, k_a, k_gb, k_ab and k_r");
}

double& multiplier(NoiseSetting& setting, NoiseParameter parameter) {
  switch (parameter) {
    case NoiseParameter::kKg:
      return setting.imu.k_g;
    case NoiseParameter::kKa:
      return setting.imu.k_a;
    case NoiseParameter::kKgb:
      return setting.imu.k_gb;
    case NoiseParameter::kKab:
      return setting.imu.k_ab;
    case NoiseParameter::kKr:
      break;
  }
  return setting.k_r;
}

double multiplier(const NoiseSetting& setting, NoiseParameter parameter) {
  NoiseSetting copy = setting;
  return multiplier(copy, parameter);
}

const char* name_of(TuningObjective objective) {
  switch (objective) {
    case TuningObjective::kAte:
      return "ate";
    case TuningObjective::kNll:
      return "nll";
    case TuningObjective::kScanNll:
      break;
  }
  return "scan_nll";
}

double nll_of(TuningObjective objective, const TrialResult& result) {
  return objective == TuningObjective::kScanNll ? result.nll : result.horizon_nll;
}

bool same_setting(const NoiseSetting& a, const NoiseSetting& b) {
  return std::all_of(std::begin(kAll), std::end(kAll),
                     [&](NoiseParameter parameter) { return multiplier(a, parameter) == multiplier(b, parameter); });
}

void check_problem(const NoiseProblem& problem) {
  require(!problem.bags.empty(), "no bag to tune on");
  require(problem.runs > 0, "a setting needs one run at least");
  require(!problem.tuned.empty(), "no coefficient to tune");
  require(positive(problem.lowest_k) && positive(problem.highest_k) && problem.lowest_k < problem.highest_k,
          "the box needs 0 < lowest k < highest k");
  require(positive(problem.prior_sigma), "the prior's width must be positive");
  require(positive(problem.nll_scale), "the factor on the log-likelihood must be positive");
  require(positive(problem.diverged_ate), "what a diverged run counts must be positive");
  for (const NoiseParameter parameter : kAll) {
    const std::string name = name_of(parameter);
    const auto times = std::count(problem.tuned.begin(), problem.tuned.end(), parameter);
    const double k = multiplier(problem.start, parameter);
    require(times < 2, name + " is given twice");
    require(positive(k), name + " must start positive, not at " + std::to_string(k));
    require(times == 0 || (k >= problem.lowest_k && k <= problem.highest_k),
            name + " starts at " + std::to_string(k) + ", outside of " + std::to_string(problem.lowest_k) + " to " +
                std::to_string(problem.highest_k));
  }
}

Eigen::VectorXd log_point(const NoiseProblem& problem, const NoiseSetting& setting) {
  Eigen::VectorXd x(problem.tuned.size());
  for (int i = 0; i < x.size(); ++i) x[i] = std::log(multiplier(setting, problem.tuned[i]));
  return x;
}

NoiseSetting setting_at(const NoiseProblem& problem, const Eigen::VectorXd& x) {
  NoiseSetting setting = problem.start;
  for (int i = 0; i < x.size(); ++i)
    multiplier(setting, problem.tuned[i]) =
        std::min(std::max(rounded(std::exp(x[i])), problem.lowest_k), problem.highest_k);
  return setting;
}

double prior_cost(const NoiseProblem& problem, const NoiseSetting& setting) {
  if (!is_likelihood(problem.objective)) return 0.0;
  return 0.5 * log_point(problem, setting).squaredNorm() / (problem.prior_sigma * problem.prior_sigma);
}

}  // namespace allan_lio
