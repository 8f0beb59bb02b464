// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace allan_lio {

/// Mean, largest and percentiles of a run's times in bounded memory, however long the run: the percentiles are exact
/// up to kKept times, and from then on those of every second, fourth, ... time.
class TimeStatistics {
 public:
  static constexpr std::size_t kKept = 32768;  // nearly an hour of scans

  void add(double seconds);

  std::uint64_t count() const { return count_; }
  double mean() const;     ///< [s], 0 without any
  double largest() const;  ///< [s], 0 without any
  /// By the nearest rank [s], 0 without any. `fraction`: 0 to 1.
  double percentile(double fraction) const;

 private:
  std::vector<double> kept_;  ///< every stride-th time [s]
  std::uint64_t stride_ = 1, count_ = 0;
  double sum_ = 0.0, largest_ = 0.0;
};

}  // namespace allan_lio
