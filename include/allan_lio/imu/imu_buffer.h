// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <vector>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// IMU samples in the order of time, handed out by intervals that need not begin or end on a sample.
class ImuBuffer {
 public:
  /// False, and nothing is kept, if the stamp is not later than the newest one's.
  bool push(const ImuSample& sample);

  bool empty() const { return samples_.empty(); }
  std::size_t size() const { return samples_.size(); }
  TimeNs oldest() const { return samples_.front().stamp; }
  TimeNs newest() const { return samples_.back().stamp; }
  const ImuSample& operator[](std::size_t i) const { return samples_[i]; }

  /// The reading at `t`, linear between its neighbours; held beyond either end of the buffer.
  /// The buffer must not be empty.
  ImuSample at(TimeNs t) const;

  /// The samples inside (from, to) with the interpolated readings at both ends: 2 or more entries,
  /// strictly increasing. Requires from < to and a non-empty buffer.
  std::vector<ImuSample> between(TimeNs from, TimeNs to) const;

  /// Longest time [s] between neighbouring samples of which the later lies in (from, to]; 0 if there is none.
  double longest_gap(TimeNs from, TimeNs to) const;

  /// A time without samples.
  struct Silence {
    double seconds = 0.0;  ///< of it in the time that was asked for [s]
    TimeNs begin = 0;      ///< not before the time that was asked for
    TimeNs end = 0;        ///< stamp of the sample that ends it, be it after the time that was asked for
  };
  /// The longest part of [from, to] between two neighbouring samples.
  Silence longest_silence(TimeNs from, TimeNs to) const;

  /// Time [s] between the two samples around `t`; 0 beyond either end of the buffer.
  double spacing_at(TimeNs t) const;

  /// Forgets what no interval that begins at or after `t` needs.
  void discard_before(TimeNs t);

  /// Takes out the samples of which `is_bad` is true; how many there were.
  template <class Predicate>
  std::size_t remove_if(Predicate is_bad) {
    const std::size_t before = samples_.size();
    samples_.erase(std::remove_if(samples_.begin(), samples_.end(), is_bad), samples_.end());
    return before - samples_.size();
  }

  void clear() { samples_.clear(); }

 private:
  std::deque<ImuSample> samples_;
};

}  // namespace allan_lio
