// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "allan_lio/calib/block_likelihood.h"

namespace allan_lio {

/// What is searched over: the logarithms of Q, N, sigma, T_b and K.
enum NoiseParameter { kQuantizationLog, kWhiteLog, kSigmaLog, kTimeLog, kWalkLog };
constexpr int kNoiseParameters = 5;
using NoiseLogs = std::array<double, kNoiseParameters>;  ///< minus infinity where the term is absent
using FreeParameters = std::array<bool, kNoiseParameters>;

NoiseTerms terms_of(const NoiseLogs& logs);
NoiseLogs logs_of(const NoiseTerms& terms);

/// ln L of a record and where it is looked for. At a lower bound a term is too small to be seen in the record.
struct LikelihoodSurface {
  BlockedRecord record;
  NoiseLogs low, high;
  double model_error = 0.0;  ///< of the pyramid

  double at(const NoiseLogs& logs) const;
};

/// A point of the surface and its height.
struct LikelihoodPoint {
  NoiseLogs logs;
  double value;
};

/// The local maximum over the free parameters, uphill from `start`: BOBYQA (Powell 2009), the steps scaled by the
/// curvature; done again from where it ended until it gains nothing, at most `rounds` times. `tolerance` is how near it
/// goes, in those scales; ln L is then lower by the order of its square.
LikelihoodPoint climb(const LikelihoodSurface& surface, const NoiseLogs& start, const FreeParameters& free, int rounds,
                      double tolerance = 0.05);

/// 1/sqrt(-d^2 ln L/dx^2): how far a parameter goes alone until ln L is half a unit lower; at most 1.
double parameter_scale(const LikelihoodSurface& surface, const NoiseLogs& logs, int parameter);

/// Where the likelihood, maximised over the other free parameters, has fallen so far that 2 (top - ln L) = `drop`.
struct ProfileEnd {
  double log = 0.0;         ///< the parameter there
  bool open = false;        ///< it does not fall so far: this is the bound of the search
  LikelihoodPoint highest;  ///< of all points seen; above the top if that was not the global maximum
};

/// From `start`, the highest point over the free parameters, which is at least as high as top - drop/2. `direction` is
/// 1 or -1.
ProfileEnd follow_profile(const LikelihoodSurface& surface, const LikelihoodPoint& start, const FreeParameters& free,
                          int parameter, int direction, double top, double drop);

}  // namespace allan_lio
