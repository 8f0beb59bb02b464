// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "allan_lio/calib/noise_problem.h"
#include "allan_lio/calib/noise_trial.h"
#include "allan_lio/sim/random.h"

namespace allan_lio {

/// An engine that asks a function.
inline RunTrials engine_of(std::function<TrialResult(const NoiseTrial&)> run) {
  return [run = std::move(run)](const std::vector<NoiseTrial>& trials) {
    std::vector<TrialResult> results;
    for (const NoiseTrial& trial : trials) results.push_back(run(trial));
    return results;
  };
}

/// An engine whose nll and ate are a function of the tuned ln k.
inline RunTrials engine_of_logs(const NoiseProblem& problem, std::function<double(const Eigen::VectorXd&)> value) {
  return engine_of([problem, value = std::move(value)](const NoiseTrial& trial) {
    TrialResult result;
    result.nll = result.horizon_nll = result.ate = value(log_point(problem, trial.setting));
    return result;
  });
}

inline NoiseProblem problem_of(std::vector<NoiseParameter> tuned, TuningObjective objective = TuningObjective::kNll) {
  NoiseProblem problem;
  problem.tuned = std::move(tuned);
  problem.objective = objective;
  return problem;
}

/// The same start for every tuned coefficient.
inline void start_at(NoiseProblem& problem, double k) {
  for (const NoiseParameter parameter : problem.tuned) multiplier(problem.start, parameter) = k;
}

/// What innovations make of the noise: groups of them, each with a variance to which every coefficient adds its share
/// in square. The negative log-likelihood above the truth's, were the samples' variances just those of the truth.
struct VarianceComponents {
  Eigen::MatrixXd shares;   ///< group x coefficient
  Eigen::VectorXd samples;  ///< in a group
  Eigen::VectorXd truth;    ///< ln k

  /// Shares between 1/20 and 20 and 200 to 1000 samples, truth within a factor of 4.5 of 1, by the seed.
  static VarianceComponents random(int coefficients, std::uint64_t seed) {
    constexpr int kGroups = 6;
    std::uint64_t counter = hash_bits(seed);
    const auto uniform = [&] { return uniform_from_bits(hash_bits(++counter)); };
    VarianceComponents model{Eigen::MatrixXd(kGroups, coefficients), Eigen::VectorXd(kGroups),
                             Eigen::VectorXd(coefficients)};
    for (int group = 0; group < kGroups; ++group) {
      model.samples[group] = 200.0 + 800.0 * uniform();
      for (int i = 0; i < coefficients; ++i) model.shares(group, i) = std::exp(6.0 * (uniform() - 0.5));
    }
    for (int i = 0; i < coefficients; ++i) model.truth[i] = 3.0 * (uniform() - 0.5);
    return model;
  }

  Eigen::VectorXd variances(const Eigen::VectorXd& x) const { return shares * (2.0 * x).array().exp().matrix(); }

  double nll(const Eigen::VectorXd& x) const {
    const Eigen::ArrayXd excess = variances(truth).array() / variances(x).array();
    return 0.5 * (samples.array() * (excess - 1.0 - excess.log())).sum();
  }
};

/// Ripples of a third of a factor of two and jumps from one point to the next, each of `size` either way.
inline double rugged(const Eigen::VectorXd& x, double size) {
  constexpr double kCell = 0.02;  // of ln k
  double value = 0.0;
  std::uint64_t cell = 1;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    value += size * std::sin(9.0 * x[i] + static_cast<double>(i));
    cell = hash_bits(cell ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x[i] / kCell))));
  }
  return value + size * (2.0 * uniform_from_bits(cell) - 1.0);
}

}  // namespace allan_lio
