// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "likelihood_surface.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace allan_lio {
namespace {

/// What NLopt's callback is given: the free parameters in units of their scales.
struct Climb {
  const LikelihoodSurface& surface;
  std::vector<int> free;
  std::vector<double> scale;
  LikelihoodPoint best;
};

double height(unsigned count, const double* x, double*, void* data) {
  Climb& climb = *static_cast<Climb*>(data);
  NoiseLogs logs = climb.best.logs;
  for (unsigned i = 0; i < count; ++i) logs[climb.free[i]] = x[i] * climb.scale[i];
  const double value = climb.surface.at(logs);
  if (value > climb.best.value) climb.best = {logs, value};
  return value;
}

/// One search by BOBYQA.
void search(Climb& climb, double first_step, double tolerance) {
  constexpr int kMostEvaluations = 400;
  const std::size_t count = climb.free.size();
  std::vector<double> x(count), low(count), high(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int parameter = climb.free[i];
    x[i] = climb.best.logs[parameter] / climb.scale[i];
    low[i] = climb.surface.low[parameter] / climb.scale[i];
    high[i] = climb.surface.high[parameter] / climb.scale[i];
    x[i] = std::min(std::max(x[i], low[i]), high[i]);
  }
  const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> optimizer(
      nlopt_create(NLOPT_LN_BOBYQA, static_cast<unsigned>(count)), nlopt_destroy);
  nlopt_set_max_objective(optimizer.get(), height, &climb);
  nlopt_set_lower_bounds(optimizer.get(), low.data());
  nlopt_set_upper_bounds(optimizer.get(), high.data());
  nlopt_set_initial_step1(optimizer.get(), first_step);
  nlopt_set_xtol_abs1(optimizer.get(), tolerance);
  nlopt_set_maxeval(optimizer.get(), kMostEvaluations);
  // However it ends, the best point is in `climb`.
  double value = 0.0;
  nlopt_optimize(optimizer.get(), x.data(), &value);
}

}  // namespace

NoiseTerms terms_of(const NoiseLogs& logs) {
  NoiseTerms terms;
  terms.quantization = std::exp(logs[kQuantizationLog]);
  terms.white = std::exp(logs[kWhiteLog]);
  terms.markov_sigma = std::exp(logs[kSigmaLog]);
  terms.markov_time = std::exp(logs[kTimeLog]);
  terms.random_walk = std::exp(logs[kWalkLog]);
  return terms;
}

NoiseLogs logs_of(const NoiseTerms& terms) {
  return {std::log(terms.quantization), std::log(terms.white), std::log(terms.markov_sigma),
          std::log(terms.markov_time), std::log(terms.random_walk)};
}

double LikelihoodSurface::at(const NoiseLogs& logs) const {
  const NoiseTerms terms = terms_of(logs);
  return haar_log_likelihood(record.levels, terms, model_error) + block_log_likelihood(record, terms);
}

double parameter_scale(const LikelihoodSurface& surface, const NoiseLogs& logs, int parameter) {
  constexpr double kStep = 1e-3, kSmallest = 1e-4, kLargest = 1.0;
  NoiseLogs below = logs, above = logs;
  below[parameter] -= kStep;
  above[parameter] += kStep;
  const double curvature = (2.0 * surface.at(logs) - surface.at(below) - surface.at(above)) / (kStep * kStep);
  return curvature > 0 ? std::min(std::max(1.0 / std::sqrt(curvature), kSmallest), kLargest) : kLargest;
}

LikelihoodPoint climb(const LikelihoodSurface& surface, const NoiseLogs& start, const FreeParameters& free, int rounds,
                      double tolerance) {
  constexpr double kFirstStep = 2.0, kLaterStep = 0.5;  // in scales
  constexpr double kGain = 0.01;                        // of ln L, which is not worth another round
  Climb climb{surface, {}, {}, {start, surface.at(start)}};
  for (int parameter = 0; parameter < kNoiseParameters; ++parameter)
    if (free[parameter]) climb.free.push_back(parameter);
  for (int round = 0; round < rounds; ++round) {
    climb.scale.clear();
    for (const int parameter : climb.free) climb.scale.push_back(parameter_scale(surface, climb.best.logs, parameter));
    const double before = climb.best.value;
    search(climb, round == 0 ? kFirstStep : kLaterStep, tolerance);
    if (climb.best.value < before + kGain) break;
  }
  return climb.best;
}

ProfileEnd follow_profile(const LikelihoodSurface& surface, const LikelihoodPoint& start, const FreeParameters& free,
                          int parameter, int direction, double top, double drop) {
  constexpr double kClose = 0.02;              // of the root of the drop
  constexpr double kLeast = 1.2, kMost = 4.0;  // growth of a step outwards
  constexpr double kMargin = 0.05;             // of a bracket, so that both its ends close in
  constexpr int kMostSteps = 20, kRounds = 3;
  const double target = std::sqrt(drop), from = start.logs[parameter];
  const double bound = direction > 0 ? surface.high[parameter] : surface.low[parameter];
  const auto root_at = [&](double value) { return std::sqrt(std::max(0.0, 2.0 * (top - value))); };
  FreeParameters others = free;
  others[parameter] = false;

  // The root of the drop is nearly a straight line over the parameter: outwards until it is above the target, then
  // between the two points that have it between them.
  double inner = from, inner_root = root_at(start.value), outer = bound, outer_root = 0.0;
  double at = from + direction * (target - inner_root) * parameter_scale(surface, start.logs, parameter);
  ProfileEnd end{bound, true, start};
  NoiseLogs warm = start.logs;
  for (int step = 0; step < kMostSteps; ++step) {
    const bool outwards = outer_root == 0.0, at_bound = outwards && direction * (at - bound) >= 0;
    if (at_bound) at = bound;
    warm[parameter] = at;
    const LikelihoodPoint point = climb(surface, warm, others, kRounds);
    if (point.value > end.highest.value) end.highest = point;
    const double root = root_at(point.value);
    if (at_bound && root < target) return end;
    end.log = at;
    end.open = false;
    if (std::abs(root - target) < kClose) return end;
    if (root < target) {
      inner = at;
      inner_root = root;
      warm = point.logs;
    } else {
      outer = at;
      outer_root = root;
    }
    if (outer_root > 0.0) {
      const double share = (target - inner_root) / (outer_root - inner_root);
      at = inner + std::min(std::max(share, kMargin), 1.0 - kMargin) * (outer - inner);
    } else {
      at = from + std::min(std::max(target / std::max(root, 1e-3), kLeast), kMost) * (at - from);
    }
  }
  return end;
}

}  // namespace allan_lio
