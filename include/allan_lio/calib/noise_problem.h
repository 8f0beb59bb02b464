// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/calib/noise_trial.h"

namespace allan_lio {

/// A coefficient that can be tuned.
enum class NoiseParameter { kKg, kKa, kKgb, kKab, kKr };

/// "k_g", "k_a", "k_gb", "k_ab", "k_r".
const char* name_of(NoiseParameter parameter);

/// The parameter of that name. Throws std::invalid_argument that lists the names.
NoiseParameter noise_parameter(const std::string& name);

double& multiplier(NoiseSetting& setting, NoiseParameter parameter);
double multiplier(const NoiseSetting& setting, NoiseParameter parameter);

/// To the bit.
bool same_setting(const NoiseSetting& a, const NoiseSetting& b);

/// What a setting is judged by.
enum class TuningObjective {
  kAte,  ///< the average of TrialResult::ate over bags and runs [m]: needs ground truth
  // Negative log-likelihoods with a prior on the coefficients, which need no ground truth:
  kNll,      ///< of what the IMU alone predicts over 3 to 30 s, TrialResult::horizon_nll
  kScanNll,  ///< of the innovations from one scan to the next, TrialResult::nll: the one that tells k_r
};

/// Whether it is measured in nats, has a prior, and profiles with intervals.
constexpr bool is_likelihood(TuningObjective objective) { return objective != TuningObjective::kAte; }

/// "ate", "nll", "scan_nll".
const char* name_of(TuningObjective objective);

/// The part of it that is minimised [nats]; `objective` is a likelihood.
double nll_of(TuningObjective objective, const TrialResult& result);

/// What is tuned on what. Searches work on x = ln k of the tuned coefficients, in the order of `tuned`.
struct NoiseProblem {
  std::vector<std::uint32_t> bags = {0};  ///< numbers of the bags tuned on: all others are held out
  std::uint32_t runs = 1;                 ///< per setting and bag
  std::vector<NoiseParameter> tuned;
  NoiseSetting start;  ///< where a search begins; coefficients that are not tuned stay there
  TuningObjective objective = TuningObjective::kNll;

  double lowest_k = 0.01, highest_k = 1000.0;  ///< the box of every tuned coefficient
  /// Of a likelihood: 1 sigma of ln k about k = 1, the log-normal prior's width. ln 10: a factor of ten costs half a
  /// nat.
  double prior_sigma = 2.302585092994046;
  /// Of a likelihood: the effective number of independent errors over their number. 1 if they are independent.
  double nll_scale = 1.0;
  /// kAte: what a run counts at most, and a diverged one (or one without a figure) always [m].
  double diverged_ate = 1000.0;
};

/// Throws std::invalid_argument that names what is wrong: no bag or no run, no coefficient or one twice, a start
/// outside the box, a width or factor that is not positive.
void check_problem(const NoiseProblem& problem);

/// x = ln k of the tuned coefficients.
Eigen::VectorXd log_point(const NoiseProblem& problem, const NoiseSetting& setting);

/// The setting at x, kept in the box, its k rounded to five digits (so that a search that comes back to a point knows
/// it again); the coefficients that are not tuned are those of the start.
NoiseSetting setting_at(const NoiseProblem& problem, const Eigen::VectorXd& x);

/// -ln of the prior without its constant: sum over the tuned k of (ln k)^2 / (2 prior_sigma^2), the density being
/// that of ln k so that it is highest at k = 1. Zero for kAte.
double prior_cost(const NoiseProblem& problem, const NoiseSetting& setting);

}  // namespace allan_lio
