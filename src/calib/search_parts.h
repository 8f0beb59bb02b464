// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "allan_lio/calib/noise_evaluator.h"

namespace allan_lio {

/// Objectives made milder for a surrogate: linear up to `base`, above it scale ln(1 + (f - base)/scale). Monotone, so
/// the minimum stays where it is, while a diverged run's penalty comes within reach of the others.
struct MildObjective {
  double base = 0.0;
  double scale = 1.0;

  /// `base` is the lowest of the values, `scale` how far their lower quarter reaches above it.
  static MildObjective of(std::vector<double> values);
  double operator()(double objective) const;
};

/// ln of the box's ends, for every tuned coefficient.
Eigen::VectorXd lower_logs(const NoiseProblem& problem);
Eigen::VectorXd upper_logs(const NoiseProblem& problem);

/// Where an optimum is expected, as far as the box reaches: a search looks here first. The space between the box's ends
/// is so large that points spread over it would mostly tell how a filter diverges.
constexpr double kLowestUsual = 0.1, kHighestUsual = 30.0;
Eigen::VectorXd lower_usual_logs(const NoiseProblem& problem);
Eigen::VectorXd upper_usual_logs(const NoiseProblem& problem);

/// Points spread over the box (McKay, Beckman and Conover 1979): each of the `count` equal slices of each coefficient
/// is taken once. One a column; the same state of `bits`, the same points.
Eigen::MatrixXd latin_hypercube(const Eigen::VectorXd& low, const Eigen::VectorXd& high, int count,
                                std::mt19937_64& bits);

/// Minimises `value` by BOBYQA in the box from x; exceptions of `value` come through. Returns the lowest point seen.
struct BoxSearch {
  Eigen::VectorXd low, high;
  double first_step = 1.0, tolerance = 1e-3;
  int most = 400;  ///< evaluations
};
Eigen::VectorXd minimise(const BoxSearch& box, const Eigen::VectorXd& x,
                         const std::function<double(const Eigen::VectorXd&)>& value);

}  // namespace allan_lio
