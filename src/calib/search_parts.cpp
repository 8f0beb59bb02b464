// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "search_parts.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <memory>
#include <stdexcept>
#include <utility>

namespace allan_lio {
namespace {

/// What NLopt's callback is given. An exception must not pass through its C code.
struct Descent {
  const std::function<double(const Eigen::VectorXd&)>& value;
  nlopt_opt optimizer = nullptr;
  Eigen::VectorXd best_point;
  double best = std::numeric_limits<double>::infinity();
  std::exception_ptr thrown;
};

double evaluate(unsigned count, const double* x, double*, void* data) {
  Descent& descent = *static_cast<Descent*>(data);
  if (descent.thrown) return descent.best;
  try {
    const Eigen::VectorXd point = Eigen::Map<const Eigen::VectorXd>(x, count);
    const double value = descent.value(point);
    if (value < descent.best) {
      descent.best = value;
      descent.best_point = point;
    }
    return value;
  } catch (...) {
    descent.thrown = std::current_exception();
    nlopt_force_stop(descent.optimizer);
    return descent.best;
  }
}

double uniform(std::mt19937_64& bits) { return static_cast<double>(bits() >> 11) / 9007199254740992.0; }  // 2^53

}  // namespace

MildObjective MildObjective::of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  MildObjective mild;
  mild.base = values.front();
  const double reach = values[values.size() / 4] - mild.base;
  mild.scale = reach > 0.0 ? reach : 1.0;
  return mild;
}

double MildObjective::operator()(double objective) const {
  const double above = objective - base;
  return above > 0.0 ? scale * std::log1p(above / scale) : above;
}

Eigen::VectorXd lower_logs(const NoiseProblem& problem) {
  return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(problem.tuned.size()), std::log(problem.lowest_k));
}

Eigen::VectorXd upper_logs(const NoiseProblem& problem) {
  return Eigen::VectorXd::Constant(static_cast<Eigen::Index>(problem.tuned.size()), std::log(problem.highest_k));
}

Eigen::VectorXd lower_usual_logs(const NoiseProblem& problem) {
  return lower_logs(problem).cwiseMax(std::log(kLowestUsual)).cwiseMin(upper_logs(problem));
}

Eigen::VectorXd upper_usual_logs(const NoiseProblem& problem) {
  return upper_logs(problem).cwiseMin(std::log(kHighestUsual)).cwiseMax(lower_logs(problem));
}

Eigen::MatrixXd latin_hypercube(const Eigen::VectorXd& low, const Eigen::VectorXd& high, int count,
                                std::mt19937_64& bits) {
  Eigen::MatrixXd points(low.size(), count);
  for (Eigen::Index row = 0; row < low.size(); ++row) {
    std::vector<int> slices(count);
    for (int i = 0; i < count; ++i) slices[i] = i;
    // std::shuffle differs between libraries.
    for (int i = count - 1; i > 0; --i) std::swap(slices[i], slices[bits() % static_cast<unsigned>(i + 1)]);
    for (int i = 0; i < count; ++i)
      points(row, i) = low[row] + (high[row] - low[row]) * (slices[i] + uniform(bits)) / count;
  }
  return points;
}

Eigen::VectorXd minimise(const BoxSearch& box, const Eigen::VectorXd& x,
                         const std::function<double(const Eigen::VectorXd&)>& value) {
  constexpr double kOfTheBox = 0.25;  // BOBYQA refuses a first step beyond half of it
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimizer(
      nlopt_create(NLOPT_LN_BOBYQA, static_cast<unsigned>(x.size())), nlopt_destroy);
  Eigen::VectorXd point = x.cwiseMax(box.low).cwiseMin(box.high);
  Descent descent{value, optimizer.get(), point, std::numeric_limits<double>::infinity(), nullptr};
  nlopt_set_min_objective(optimizer.get(), evaluate, &descent);
  nlopt_set_lower_bounds(optimizer.get(), box.low.data());
  nlopt_set_upper_bounds(optimizer.get(), box.high.data());
  nlopt_set_initial_step1(optimizer.get(), std::min(box.first_step, kOfTheBox * (box.high - box.low).minCoeff()));
  nlopt_set_xtol_abs1(optimizer.get(), box.tolerance);
  nlopt_set_maxeval(optimizer.get(), std::max(1, box.most));
  // However a search ends, the best point is in `descent`; one that cannot begin must not look like an end.
  double last = 0.0;
  const nlopt_result end = nlopt_optimize(optimizer.get(), point.data(), &last);
  if (descent.thrown) std::rethrow_exception(descent.thrown);
  if (end == NLOPT_INVALID_ARGS || end == NLOPT_OUT_OF_MEMORY)
    throw std::runtime_error("BOBYQA: cannot search in this box");
  return descent.best_point;
}

}  // namespace allan_lio
