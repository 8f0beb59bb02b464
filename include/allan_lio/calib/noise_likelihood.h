// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/calib/allan_fit.h"

namespace allan_lio {

/// Maximum-likelihood fit of quantisation, white noise, a Gauss-Markov bias and a random walk to one axis, starting
/// from `start` (the least-squares fit). Gives the same figures as AllanFit with Gauss-Markov bias; `instability`
/// stays unset. A bias that is not seen is left out of the terms and bounded for T_b up to a tenth of the record.
/// Differences over less than `shortest` [s] are left out (AxisAnalysis::shortest): a filter in the sensor makes them
/// something else than the model; quantisation is left out with them. Where the others depart from it all the same, by
/// model_error, they weigh less. Throws std::invalid_argument if the record is too short.
AllanFit fit_by_likelihood(const IntegratedSeries& series, const AllanFit& start, double shortest = 0.0);

}  // namespace allan_lio
