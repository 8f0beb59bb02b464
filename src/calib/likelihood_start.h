// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "likelihood_surface.h"

namespace allan_lio {

/// Cuts the record into blocks, short against the T_b of `start`, and sets the bounds of the search by what the record
/// can tell. Levels of the pyramid below `shortest` [s] are left out. Throws std::invalid_argument if the record is too
/// short or does not change.
LikelihoodSurface make_likelihood_surface(const IntegratedSeries& series, const AllanFit& start, double shortest);

/// Where to begin to look: several, for the likelihood has more than one hill over T_b.
std::vector<NoiseLogs> starting_points(const LikelihoodSurface& surface, const AllanFit& start);

}  // namespace allan_lio
