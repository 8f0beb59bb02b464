// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/time_statistics.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {

void TimeStatistics::add(double seconds) {
  if (count_ % stride_ == 0) {
    if (kept_.size() == kKept) {
      for (std::size_t i = 0; 2 * i < kKept; ++i) kept_[i] = kept_[2 * i];
      kept_.resize(kKept / 2);
      stride_ *= 2;
    }
    // kKept is even, so that this one is due by the doubled stride too.
    kept_.push_back(seconds);
  }
  ++count_;
  sum_ += seconds;
  largest_ = std::max(largest_, seconds);
}

double TimeStatistics::mean() const { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }

double TimeStatistics::largest() const { return largest_; }

double TimeStatistics::percentile(double fraction) const {
  if (kept_.empty()) return 0.0;
  std::vector<double> sorted = kept_;
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::ceil(fraction * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace allan_lio
