// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace allan_lio {

/// One point of an Allan variance curve of a rate y (angular rate, specific force, frequency).
struct AllanPoint {
  std::int64_t m = 0;        ///< averaging factor: tau / tau0
  double tau = 0.0;          ///< averaging time [s]
  double variance = 0.0;     ///< sigma^2(tau) [u^2], u the unit of y
  std::int64_t terms = 0;    ///< squared differences that it is the mean of
  double record_time = 0.0;  ///< length of the record that they span [s]
  double slide_time = 0.0;   ///< what the first of the three x moves over: terms times their spacing [s]
};

using AllanCurve = std::vector<AllanPoint>;

/// The integral of a rate, x[k] = tau0 * (y[0] + ... + y[k-1]), in pieces with nothing known in between.
/// A constant may have been taken off y: it cancels in every Allan variance.
struct IntegratedSeries {
  double tau0 = 1.0;                     ///< spacing of x [s]
  std::vector<double> x;                 ///< the pieces one after the other, each begins with its own x[0] [u s]
  std::vector<std::size_t> starts = {};  ///< index of each piece's first x; empty: one piece that is all of x
};

/// Averaging factors from 1 to `largest`, about `per_decade` a decade, each once, ascending.
std::vector<std::int64_t> log_spaced_factors(std::int64_t largest, int per_decade);

/// Overlapping Allan variance, sigma^2(m tau0) = <(x[k+2m] - 2 x[k+m] + x[k])^2> / (2 (m tau0)^2) over every k for
/// which the three lie in one piece (NIST SP 1065, section 5.2.4). A factor too long for every piece is left out.
/// `threads` does not change the result.
AllanCurve overlapping_allan_variance(const IntegratedSeries& series, const std::vector<std::int64_t>& factors,
                                      int threads = 1);

/// The same with k = 0, m, 2m, ... of each piece (NIST SP 1065, section 5.2.2).
AllanCurve non_overlapping_allan_variance(const IntegratedSeries& series, const std::vector<std::int64_t>& factors);

}  // namespace allan_lio
