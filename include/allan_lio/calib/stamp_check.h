// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// What the stamps of one topic tell.
struct StampReport {
  std::size_t count = 0;
  std::size_t not_newer = 0;   ///< than the newest before: copies, and stamps that went back
  TimeNs first = 0, last = 0;  ///< smallest and largest
  double interval = 0.0;       ///< median of the steps forward [s]; 0 for fewer than two
  double jitter = 0.0;         ///< the step that 19 of 20 stay within, less the median, or the same downwards [s]
  std::size_t gaps = 0;        ///< steps of more than kGap intervals
  double longest_gap = 0.0;    ///< [s]
  TimeNs gap_at = 0;           ///< where the longest one begins
  double lost = 0.0;           ///< messages that would fill the gaps

  static constexpr double kGap = 1.5;

  double rate() const { return interval > 0.0 ? 1.0 / interval : 0.0; }  ///< [Hz]
};

/// `stamps` in the order of arrival.
StampReport check_stamps(const std::vector<TimeNs>& stamps);

/// The median of differences such as arrival less stamp [s]; 0 for none. Sorts in part.
double median_seconds(std::vector<TimeNs> differences);

}  // namespace allan_lio
