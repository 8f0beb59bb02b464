// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "allan_lio/calib/allan_variance.h"

namespace allan_lio {

/// The terms of the noise model of one axis; a term that is zero is absent. u is the unit of the rate.
struct NoiseTerms {
  double quantization = 0.0;  ///< Q [u s]
  double white = 0.0;         ///< N [u/sqrt(Hz)]
  double instability = 0.0;   ///< B of flicker noise [u]
  double random_walk = 0.0;   ///< K [u/s/sqrt(Hz)]
  double markov_sigma = 0.0;  ///< steady-state deviation of a first-order Gauss-Markov bias [u]
  double markov_time = 1.0;   ///< its correlation time T_b [s]
};

/// sigma^2(tau) = 3 Q^2/tau^2 + N^2/tau + B^2 2 ln2/pi + K^2 tau/3 + S_b T_b F(tau/T_b) (theory section 3), [u^2].
double model_allan_variance(const NoiseTerms& terms, double tau);

/// A coefficient with its 95 % interval. Where it is not observable the record only bounds it: from `low` (often
/// zero) to `high` (perhaps infinite), and `value` is what the fit put there, for drawing.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = std::numeric_limits<double>::infinity();
  bool observable = false;
};

/// One model fitted to one axis.
struct AllanFit {
  NoiseTerms terms;          ///< the fit itself
  Estimate quantization;     ///< Q [u s]
  Estimate white;            ///< N [u/sqrt(Hz)]
  Estimate instability;      ///< B [u]; of the flicker model
  Estimate random_walk;      ///< K [u/s/sqrt(Hz)]
  Estimate markov_flat;      ///< sigma_b, the Gauss-Markov bias's Allan deviation at its peak [u]
  Estimate markov_time;      ///< T_b [s]
  double misfit = 0.0;       ///< chi^2 over its degrees of freedom; about 1 if the model holds
  double model_error = 0.0;  ///< by which share the variances depart from the model; the intervals allow for it [1]
};

/// The flat part of the fitted curve, where its slope is zero: its minimum, or with a Gauss-Markov bias that fits
/// better the peak of the bias's own curve.
struct FlatPart {
  Estimate deviation;  ///< sigma_b, the curve's Allan deviation there [u]
  Estimate tau;        ///< tau_flat [s]
  Estimate bias_time;  ///< T_b = tau_flat/1.8926 [s]
};

struct AxisAnalysis {
  AllanFit flicker;                 ///< Q, N, B, K
  AllanFit markov;                  ///< Q, N, Gauss-Markov bias, K
  double shortest = 0.0;            ///< the fit's first averaging time [s]
  bool markov_fits_better = false;  ///< by the misfit
  FlatPart flat;                    ///< of the model that fits better
  const AllanFit& best() const { return markov_fits_better ? markov : flicker; }
};

/// A point's own 95 % interval, from the equivalent degrees of freedom that `terms` give it.
struct DeviationBand {
  double low = 0.0, high = 0.0;  ///< Allan deviations [u]
};

/// Fits both models by weighted non-negative least squares to the points with tau from `shortest` [s] up to a fifth
/// of the record. Where a sensor filters its output its noise is not white at the shortest times: with `shortest` 0
/// the fit begins at the first of tau0 times 1, 3, 10, 30, 100 from which on the model holds within a few percent.
/// Throws std::invalid_argument if fewer than six such points are there or a variance is not finite.
AxisAnalysis fit_allan_variance(const AllanCurve& curve, double tau0, double shortest = 0.0);

/// The flat part of a fit with a Gauss-Markov bias: the peak of the bias's own Allan deviation, where F has its
/// maximum (paper, `new_S`).
FlatPart flat_of_markov(const AllanFit& fit);

/// One band a point of the curve.
std::vector<DeviationBand> deviation_bands(const AllanCurve& curve, const NoiseTerms& terms, double tau0);

}  // namespace allan_lio
