// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_likelihood.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "allan_lio/calib/chi_square.h"
#include "allan_lio/imu/imu_noise.h"
#include "likelihood_start.h"
#include "likelihood_surface.h"

// The likelihood is that of an orthogonal transform of the samples: the Haar pyramid inside blocks of 2^L samples,
// whose differences are independent for white noise, and the means of the blocks, whose joint density a Kalman filter
// gives exactly (block_likelihood.h). Where the block is short against T_b almost nothing of the bias is inside the
// blocks, so that taking those differences as independent costs nothing, and a record of millions of samples is as
// cheap as one of ten thousand.

namespace allan_lio {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTwoSided = 3.8415;  // 95 % of chi^2 of one degree of freedom
constexpr double kOneSided = 2.7055;  // 90 %: a term that cannot be negative
// Under no bias at all its T_b can be anything: the gain in 2 ln L that is exceeded once in twenty such records.
constexpr double kBiasGain = 5.99;
constexpr double kFine = 1e-3;  // tolerance of the fit itself

/// Quantisation is a matter of the shortest times: without them it would only take its share of N.
FreeParameters parameters_of(double tau0, double shortest) { return {shortest < 1.5 * tau0, true, true, true, true}; }

LikelihoodPoint find_maximum(const LikelihoodSurface& surface, const std::vector<NoiseLogs>& starts,
                             const FreeParameters& free) {
  constexpr int kRounds = 5;
  LikelihoodPoint best{starts.front(), -kInfinity};
  for (NoiseLogs start : starts) {
    if (!free[kQuantizationLog]) start[kQuantizationLog] = -kInfinity;
    const LikelihoodPoint point = climb(surface, start, free, 1);
    if (point.value > best.value) best = point;
  }
  return climb(surface, climb(surface, best.logs, free, kRounds).logs, free, 1, kFine);
}

/// The maximum without a term of `free`.
LikelihoodPoint maximum_without(const LikelihoodSurface& surface, const LikelihoodPoint& maximum, FreeParameters free,
                                int parameter) {
  constexpr int kRounds = 4;
  NoiseLogs start = maximum.logs;
  free[parameter] = false;
  start[parameter] = -kInfinity;
  if (parameter == kSigmaLog) free[kTimeLog] = false;
  // What the term stood for may need another: a random walk where the bias was slow, a slower bias where there was a
  // random walk.
  NoiseLogs other = start;
  if (parameter == kSigmaLog)
    other[kWalkLog] = std::max(start[kWalkLog], maximum.logs[kSigmaLog] - 0.5 * maximum.logs[kTimeLog]);
  if (parameter == kWalkLog && free[kTimeLog]) other[kTimeLog] = 0.5 * (start[kTimeLog] + surface.high[kTimeLog]);
  const LikelihoodPoint first = climb(surface, start, free, kRounds);
  if (other == start) return first;
  const LikelihoodPoint second = climb(surface, other, free, kRounds);
  return second.value > first.value ? second : first;
}

/// Estimates and their intervals by profile likelihood, in the model of `free`.
class Intervals {
 public:
  Intervals(const LikelihoodSurface& surface, const LikelihoodPoint& maximum, const FreeParameters& free)
      : surface_(surface), free_(free), maximum_(maximum), highest_(maximum) {}

  /// Of a term that may be zero: observable if the record is less likely without it.
  Estimate of_term(int parameter) {
    const double loss = 2.0 * (maximum_.value - maximum_without(surface_, maximum_, free_, parameter).value);
    if (loss > kTwoSided) return of(parameter);
    Estimate estimate;
    estimate.value = std::exp(maximum_.logs[parameter]);
    estimate.high = end_of(parameter, 1, loss > kOneSided ? kTwoSided : kOneSided);
    estimate.observable = loss > kOneSided && std::isfinite(estimate.high);
    return estimate;
  }

  /// Of what is there. If the record does not bound it from above, it is not observable.
  Estimate of(int parameter) {
    Estimate estimate;
    estimate.value = std::exp(maximum_.logs[parameter]);
    estimate.high = end_of(parameter, 1, kTwoSided);
    estimate.observable = std::isfinite(estimate.high);
    estimate.low = end_of(parameter, -1, estimate.observable ? kTwoSided : kOneSided);
    return estimate;
  }

  /// The highest point seen on the way.
  const LikelihoodPoint& highest() const { return highest_; }

 private:
  /// The profile's end, zero or infinite if it is open.
  double end_of(int parameter, int direction, double drop) {
    const ProfileEnd end = follow_profile(surface_, maximum_, free_, parameter, direction, maximum_.value, drop);
    if (end.highest.value > highest_.value) highest_ = end.highest;
    if (end.open) return direction > 0 ? kInfinity : 0.0;
    return std::exp(end.log);
  }

  const LikelihoodSurface& surface_;
  FreeParameters free_;
  LikelihoodPoint maximum_, highest_;
};

/// How large a bias that is not seen may be: the largest 95 % bound over T_b between a thousandth and a tenth of the
/// record. One that is slower is a random walk there.
Estimate bound_of_bias(const LikelihoodSurface& surface, const LikelihoodPoint& without, FreeParameters free) {
  constexpr int kRounds = 3;
  const double record = surface.record.block_time * static_cast<double>(surface.record.means.size());
  free[kSigmaLog] = true;
  double high = surface.low[kSigmaLog];
  for (const double share : {1e-3, 3e-3, 1e-2, 3e-2, 1e-1}) {
    NoiseLogs start = without.logs;
    start[kTimeLog] = std::min(std::max(std::log(share * record), surface.low[kTimeLog]), surface.high[kTimeLog]);
    start[kSigmaLog] = start[kWhiteLog] - 0.5 * start[kTimeLog];  // of N's size at that tau
    const LikelihoodPoint there = climb(surface, start, free, kRounds);
    const ProfileEnd end = follow_profile(surface, there, free, kSigmaLog, 1, there.value, kOneSided);
    high = std::max(high, end.open ? kInfinity : end.log);
  }
  Estimate estimate;
  estimate.high = std::exp(high);
  return estimate;
}

/// chi^2 of the pyramid inside the blocks.
double pyramid_chi_square(const LikelihoodSurface& surface, const NoiseTerms& terms, double model_error) {
  double sum = 0.0;
  for (const HaarLevel& level : surface.record.levels) {
    const double excess = level.variance / model_allan_variance(terms, level.tau) - 1.0;
    sum += excess * excess / squared_error(level, model_error);
  }
  return sum;
}

/// By which share the pyramid's variances depart from the fit; zero unless that is beyond chance.
double find_model_error(const LikelihoodSurface& surface, const NoiseTerms& terms) {
  constexpr double kChance = 0.999, kSmallest = 1e-4;
  constexpr double kLargest = 0.3;  // the pyramid must go on holding N, or the filter takes any long wave for it
  constexpr int kHalvings = 30;
  const double freedom = static_cast<double>(surface.record.levels.size()) - 2.0;  // N and Q are fitted to it
  if (freedom < 1.0 || pyramid_chi_square(surface, terms, 0.0) < chi_square_quantile(kChance, freedom)) return 0.0;
  double low = std::log(kSmallest), high = std::log(kLargest);
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (pyramid_chi_square(surface, terms, std::exp(middle)) > freedom ? low : high) = middle;
  }
  return std::exp(high);
}

/// chi^2 per degree of freedom of that pyramid and of the one of the filter's prediction errors.
double misfit_of(const LikelihoodSurface& surface, const NoiseTerms& terms, int parameters) {
  constexpr std::int64_t kFewest = 8;  // differences that a level needs
  BlockedRecord errors;
  block_log_likelihood(surface.record, terms, &errors.means);
  double sum = pyramid_chi_square(surface, terms, surface.model_error);
  auto count = static_cast<int>(surface.record.levels.size());
  for (const HaarLevel& level : haar_pyramid(errors.means, {0}, 1.0)) {
    if (level.count < kFewest) continue;
    const double excess = level.variance * level.tau - 1.0;
    sum += excess * excess / squared_error(level, 0.0);
    ++count;
  }
  return sum / std::max(1, count - parameters);
}

Estimate scaled(Estimate estimate, double factor) {
  estimate.value *= factor;
  estimate.low *= factor;
  estimate.high *= factor;
  return estimate;
}

/// Q, N and K in the model of `free`, and the bias if it is there. Gives back the highest point seen.
LikelihoodPoint fill_fit(const LikelihoodSurface& surface, const LikelihoodPoint& maximum, const FreeParameters& free,
                         AllanFit& fit) {
  Intervals intervals(surface, maximum, free);
  fit.terms = terms_of(maximum.logs);
  fit.white = intervals.of(kWhiteLog);
  if (free[kQuantizationLog]) fit.quantization = intervals.of_term(kQuantizationLog);
  // A Q that cannot be negative takes its share of N where there is none (Self and Liang 1987): what N may be without
  // it belongs to N's interval too.
  if (free[kQuantizationLog] && !fit.quantization.observable) {
    FreeParameters others = free;
    others[kQuantizationLog] = false;
    const LikelihoodPoint without = maximum_without(surface, maximum, free, kQuantizationLog);
    const Estimate alone = Intervals(surface, without, others).of(kWhiteLog);
    fit.white.low = std::min(fit.white.low, alone.low);
    fit.white.high = std::max(fit.white.high, alone.high);
  }
  fit.random_walk = intervals.of_term(kWalkLog);
  if (free[kSigmaLog]) {
    fit.markov_flat = intervals.of(kSigmaLog);
    fit.markov_time = intervals.of(kTimeLog);
  }
  return intervals.highest();
}

}  // namespace

AllanFit fit_by_likelihood(const IntegratedSeries& series, const AllanFit& start, double shortest) {
  constexpr double kHigher = 0.02;  // of ln L: what was taken for the maximum is none
  constexpr int kMostMaxima = 3, kRounds = 5, kErrorPasses = 3;
  LikelihoodSurface surface = make_likelihood_surface(series, start, shortest);
  const std::vector<NoiseLogs> starts = starting_points(surface, start);
  FreeParameters free = parameters_of(series.tau0, shortest);
  LikelihoodPoint maximum = find_maximum(surface, starts, free);
  for (int pass = 0; pass < kErrorPasses; ++pass) {
    const double model_error = find_model_error(surface, terms_of(maximum.logs));
    if (model_error == surface.model_error) break;
    surface.model_error = model_error;
    maximum = find_maximum(surface, starts, free);
  }
  LikelihoodPoint without = maximum_without(surface, maximum, free, kSigmaLog);
  without.logs[kTimeLog] = 0.0;  // of nothing
  const bool bias = 2.0 * (maximum.value - without.value) > kBiasGain;
  if (!bias) free[kSigmaLog] = free[kTimeLog] = false;
  if (!bias) without = climb(surface, without.logs, free, 1, kFine);
  LikelihoodPoint top = bias ? maximum : without;
  AllanFit fit;
  for (int attempt = 0; attempt < kMostMaxima; ++attempt) {
    fit = AllanFit();
    const LikelihoodPoint highest = fill_fit(surface, top, free, fit);
    if (highest.value < top.value + kHigher) break;
    top = climb(surface, highest.logs, free, kRounds);
  }
  if (!bias) fit.markov_flat = bound_of_bias(surface, without, free);
  // sigma_b^2 = 2 sigma^2 F(lambda*).
  fit.markov_flat = scaled(fit.markov_flat, std::sqrt(2.0 * gauss_markov_peak_value()));
  const int parameters = 1 + fit.quantization.observable + fit.random_walk.observable + (bias ? 2 : 0);
  fit.model_error = surface.model_error;
  fit.misfit = misfit_of(surface, fit.terms, parameters);
  return fit;
}

}  // namespace allan_lio
