// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/calib/allan_fit.h"

namespace allan_lio {

/// Simulated records of one noise, each fitted: does the fit give back what was put in, and how often do its 95 %
/// intervals hold it.
struct FitStudy {
  NoiseTerms truth;
  double rate = 100.0;             ///< [Hz]
  double duration = 6.0 * 3600.0;  ///< of each record [s]
  int records = 200;
  std::uint64_t first_seed = 1;
  bool markov = false;      ///< the model with the Gauss-Markov bias instead of flicker noise
  bool likelihood = false;  ///< fit_by_likelihood() instead of least squares; only with `markov`
};

/// What came out for one coefficient.
struct CoefficientStudy {
  std::string name, unit;  ///< "N", "u/sqrt(Hz)"
  double truth = 0.0;
  double mean = 0.0;    ///< of the estimates
  double spread = 0.0;  ///< their standard deviation
  int inside = 0;       ///< records whose interval holds the truth
  int observable = 0;   ///< records that call it observable
  int records = 0;
};

/// Q, N, B or sigma_b and T_b, K. `threads` does not change the result.
std::vector<CoefficientStudy> run_study(const FitStudy& study, int threads);

}  // namespace allan_lio
