// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_grid.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace allan_lio {
namespace {

using Lists = std::vector<std::vector<double>>;

/// One list per coefficient of `order`, all checked.
Lists lists_for(const NoiseProblem& problem, const std::vector<NoiseParameter>& order, const Lists& values) {
  if (values.size() != 1 && values.size() != order.size())
    throw std::invalid_argument("grid: " + std::to_string(values.size()) + " lists of values for " +
                                std::to_string(order.size()) + " coefficients: give one for all, or one each");
  Lists lists = values.size() == order.size() ? values : Lists(order.size(), values.front());
  for (std::size_t i = 0; i < lists.size(); ++i) {
    const std::string name = name_of(order[i]);
    if (lists[i].empty()) throw std::invalid_argument("grid: " + name + " has no values");
    for (const double k : lists[i])
      if (!(k >= problem.lowest_k && k <= problem.highest_k))
        throw std::invalid_argument("grid: " + name + " = " + std::to_string(k) + " is outside of " +
                                    std::to_string(problem.lowest_k) + " to " + std::to_string(problem.highest_k));
  }
  return lists;
}

std::size_t lowest(const NoiseEvaluator& evaluator, const std::vector<std::size_t>& table) {
  const auto lower = [&](std::size_t a, std::size_t b) {
    return evaluator.evaluations()[a].objective < evaluator.evaluations()[b].objective;
  };
  return *std::min_element(table.begin(), table.end(), lower);
}

}  // namespace

std::vector<double> paper_grid() { return {10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 45.0, 50.0}; }

GridResult search_grid(NoiseEvaluator& evaluator, const Lists& values) {
  const NoiseProblem& problem = evaluator.problem();
  const Lists lists = lists_for(problem, problem.tuned, values);
  std::vector<NoiseSetting> settings = {problem.start};
  for (std::size_t i = 0; i < lists.size(); ++i) {
    std::vector<NoiseSetting> longer;
    for (NoiseSetting setting : settings) {
      for (const double k : lists[i]) {
        multiplier(setting, problem.tuned[i]) = k;
        longer.push_back(setting);
      }
    }
    settings.swap(longer);
  }
  GridResult result;
  result.table = evaluator.evaluate(settings);
  result.best = lowest(evaluator, result.table);
  return result;
}

std::vector<NoiseParameter> paper_order(const NoiseProblem& problem) {
  std::vector<NoiseParameter> order;
  for (const NoiseParameter parameter :
       {NoiseParameter::kKa, NoiseParameter::kKg, NoiseParameter::kKab, NoiseParameter::kKgb, NoiseParameter::kKr})
    if (std::count(problem.tuned.begin(), problem.tuned.end(), parameter) > 0) order.push_back(parameter);
  return order;
}

std::vector<SequentialStep> search_sequentially(NoiseEvaluator& evaluator, const std::vector<NoiseParameter>& order,
                                                const Lists& values) {
  const std::vector<NoiseParameter>& tuned = evaluator.problem().tuned;
  if (order.size() != tuned.size() || !std::is_permutation(order.begin(), order.end(), tuned.begin()))
    throw std::invalid_argument("sequential: the order must name every tuned coefficient once");
  const Lists lists = lists_for(evaluator.problem(), order, values);
  NoiseSetting kept = evaluator.problem().start;
  std::vector<SequentialStep> steps;
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::vector<NoiseSetting> settings = {kept};
    for (const double k : lists[i]) {
      settings.push_back(kept);
      multiplier(settings.back(), order[i]) = k;
    }
    SequentialStep step;
    step.parameter = order[i];
    step.table = evaluator.evaluate(settings);
    step.best = lowest(evaluator, step.table);
    kept = evaluator.evaluations()[step.best].setting;
    steps.push_back(step);
  }
  return steps;
}

}  // namespace allan_lio
