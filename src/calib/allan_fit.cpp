// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/allan_fit.h"

#include <algorithm>
#include <cmath>

#include "allan_fitter.h"
#include "allan_lio/calib/chi_square.h"
#include "allan_lio/imu/imu_noise.h"

namespace allan_lio {
namespace {

double square(double x) { return x * x; }

AxisAnalysis analyse(const AllanCurve& curve, double tau0, double shortest) {
  const AllanFitter fitter(curve, tau0, shortest);
  AxisAnalysis analysis;
  analysis.shortest = shortest;
  analysis.flicker = fitter.fit({kQuantization, kWhite, kInstability, kRandomWalk});
  analysis.markov = fitter.fit({kQuantization, kWhite, kMarkov, kRandomWalk});
  // Judged with the same error for both, that of the better one.
  const double error = std::min(analysis.flicker.model_error, analysis.markov.model_error);
  analysis.markov_fits_better =
      analysis.markov.markov_flat.observable && analysis.markov.markov_time.observable &&
      fitter.criterion(analysis.markov, 5.0, error) < fitter.criterion(analysis.flicker, 4.0, error);
  analysis.flat =
      analysis.markov_fits_better ? flat_of_markov(analysis.markov) : fitter.flat_of_flicker(analysis.flicker);
  return analysis;
}

}  // namespace

FlatPart flat_of_markov(const AllanFit& fit) {
  const double lambda = gauss_markov_peak_lambda();
  FlatPart flat;
  flat.deviation = fit.markov_flat;
  flat.bias_time = fit.markov_time;
  flat.tau = {lambda * fit.markov_time.value, lambda * fit.markov_time.low, lambda * fit.markov_time.high,
              fit.markov_time.observable};
  return flat;
}

double model_allan_variance(const NoiseTerms& terms, double tau) {
  // S_b T_b = 2 sigma^2.
  return allan_column(kQuantization, tau, 1.0) * square(terms.quantization) +
         allan_column(kWhite, tau, 1.0) * square(terms.white) +
         allan_column(kInstability, tau, 1.0) * square(terms.instability) +
         allan_column(kRandomWalk, tau, 1.0) * square(terms.random_walk) +
         2.0 * square(terms.markov_sigma) * gauss_markov_allan_shape(tau / terms.markov_time);
}

AxisAnalysis fit_allan_variance(const AllanCurve& curve, double tau0, double shortest) {
  if (shortest > 0.0) return analyse(curve, tau0, shortest);
  constexpr double kHolds = 0.03, kBetter = 0.8;
  AxisAnalysis best = analyse(curve, tau0, tau0);
  double record = 0.0;
  for (const AllanPoint& point : curve) record = std::max(record, point.record_time);
  for (const double factor : {3.0, 10.0, 30.0, 100.0}) {
    // White noise must stay in sight, and the bias needs its decades.
    const double begin = factor * tau0;
    if (best.best().model_error <= kHolds || begin > 0.5 || begin > 1e-3 * record) break;
    const AxisAnalysis later = analyse(curve, tau0, begin);
    if (later.best().white.observable && later.best().model_error < kBetter * best.best().model_error) best = later;
  }
  return best;
}

std::vector<DeviationBand> deviation_bands(const AllanCurve& curve, const NoiseTerms& terms, double tau0) {
  const Eigen::VectorXd variances = AllanCovariance(curve, tau0).variances(terms);
  std::vector<DeviationBand> bands;
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const double freedom = std::max(
        1.0, 2.0 * square(model_allan_variance(terms, curve[i].tau)) / variances[static_cast<Eigen::Index>(i)]);
    bands.push_back({std::sqrt(curve[i].variance * freedom / chi_square_quantile(0.975, freedom)),
                     std::sqrt(curve[i].variance * freedom / chi_square_quantile(0.025, freedom))});
  }
  return bands;
}

}  // namespace allan_lio
