// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace allan_lio {

/// Tells by the numbers in the headers of a topic (header.seq) how many messages were sent and did not arrive, as when
/// a queue of roscpp's overflows. Where the numbers don't count messages nothing is told: a driver that leaves them 0,
/// two publishers on one topic, one in n messages passed on by a throttle.
class SequenceWatch {
 public:
  /// So many numbers must follow one another without a gap before any gap counts, and a gap counts when so many more
  /// have come after it without a step back.
  static constexpr std::size_t kSettled = 20;

  void add(std::uint32_t number) {
    const std::uint32_t step = number - newest_;  // 1 from the largest number to 0 too
    const bool first = !begun_;
    begun_ = true;
    newest_ = number;
    if (first) return;
    if (step == 0 || step > kBackwards) return begin_again();
    if (in_a_row_ < kSettled) {
      in_a_row_ = step == 1 ? in_a_row_ + 1 : 0;
      return;
    }
    unsettled_.push_back(step - 1);
    if (unsettled_.size() <= kSettled) return;
    lost_ += unsettled_.front();
    unsettled_.pop_front();
  }

  /// Since the first message.
  std::uint64_t lost() const { return lost_; }

 private:
  static constexpr std::uint32_t kBackwards = 1U << 31;

  /// The publisher has started anew, or the numbers are of several.
  void begin_again() {
    in_a_row_ = 0;
    unsettled_.clear();
  }

  bool begun_ = false;
  std::uint32_t newest_ = 0;
  std::size_t in_a_row_ = 0;
  std::deque<std::uint32_t> unsettled_;  ///< what each of the last messages skipped
  std::uint64_t lost_ = 0;
};

}  // namespace allan_lio
