// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// Tells by the IMU's stamps that a recording begins anew (a bag in a loop, a clock set back).
class RecordingWatch {
 public:
  /// Stamps that lie back by more than this are of a new recording, if so many in a row say so; else they are late or
  /// damaged, and the estimator drops them.
  static constexpr TimeNs kBackInTime = 1 * kNsPerSecond;
  static constexpr int kSamplesBackInTime = 10;

  /// True for a sample of a new recording, once enough of them have come. Otherwise the sample counts as one of this.
  bool begins_anew(TimeNs stamp) {
    in_a_row_ = stamp < newest_ - kBackInTime ? in_a_row_ + 1 : 0;
    if (in_a_row_ >= kSamplesBackInTime) return true;
    // A stamp far ahead counts once the next one confirms it: one that is damaged would make all others old.
    const bool leap = newest_ != 0 && stamp > newest_ + kBackInTime && !(leapt_to_ != 0 && stamp >= leapt_to_);
    leapt_to_ = leap ? stamp : 0;
    if (!leap) newest_ = std::max(newest_, stamp);
    return false;
  }

  /// Of the samples so far; 0 before the first.
  TimeNs newest() const { return newest_; }

 private:
  TimeNs newest_ = 0;
  TimeNs leapt_to_ = 0;  // 0: the last stamp was no leap ahead
  int in_a_row_ = 0;
};

}  // namespace allan_lio
