// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// Tells which samples of an evenly sampling sensor are missing, by stamps that come late now and then. A late sample
/// that the following ones make up for is no gap; the stamps are otherwise only used to learn the period.
class SampleGrid {
 public:
  static constexpr std::int64_t kUndecided = -1;

  /// The median period of the stamps, which ascend [ns]. Needs two at least.
  static double guess_period(const std::vector<TimeNs>& stamps);

  /// `period` [ns]: a first guess, to be refined.
  explicit SampleGrid(double period) : guess_(period) {}

  /// The first sample of a piece: nothing is known of the time before it.
  void begin_piece(TimeNs stamp);

  /// How many samples are missing before the first of `held`, or kUndecided if more must be seen to tell. `no_more`:
  /// decide by what there is.
  std::int64_t missing_before(const std::deque<ImuSample>& held, bool no_more) const;

  /// Takes the next sample, with `missing` ones before it.
  void take(TimeNs stamp, std::int64_t missing);

  /// Mean over the whole record, gaps left out [ns].
  double period() const;

  /// How the stamps scatter about an even grid that follows slow drifts of the clock, rms [s].
  double jitter() const;

 private:
  double running_period() const;

  double guess_;                  // [ns]
  TimeNs origin_ = 0, last_ = 0;  // stamps of the piece's first and of the last sample
  // Where the last sample would be without delay, and on the average delay [ns since origin_].
  double prompt_ = 0.0, centre_ = 0.0;
  TimeNs time_ = 0;  // within pieces [ns]
  std::int64_t steps_ = 0;
  double sum_of_squares_ = 0.0;  // of the stamps against centre_ [ns^2]
  std::int64_t scattered_ = 0;
};

}  // namespace allan_lio
