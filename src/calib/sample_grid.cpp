// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/sample_grid.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr std::size_t kLag = 64;        // steps over which the first guess looks: longer than a driver's batches
constexpr double kGuessWeight = 256.0;  // steps that the first guess counts as
// Periods of delay from which on a sample may follow a gap: more than half, since delays only ever add.
constexpr double kLate = 0.7;
constexpr std::size_t kLookAhead = 64;      // samples that a delay has to be made up in, and twice as many as are late
constexpr std::size_t kLongestLook = 4096;  // samples
constexpr double kPromptDrift = 0.01;       // periods a sample by which the prompt grid may become later
constexpr double kCentreGain = 1.0 / 32.0;

}  // namespace

double SampleGrid::guess_period(const std::vector<TimeNs>& stamps) {
  const std::size_t lag = std::min(kLag, stamps.size() - 1);
  std::vector<TimeNs> spans;
  for (std::size_t i = lag; i < stamps.size(); ++i) spans.push_back(stamps[i] - stamps[i - lag]);
  const auto middle = spans.begin() + static_cast<std::ptrdiff_t>(spans.size() / 2);
  std::nth_element(spans.begin(), middle, spans.end());
  return static_cast<double>(*middle) / static_cast<double>(lag);
}

void SampleGrid::begin_piece(TimeNs stamp) {
  origin_ = last_ = stamp;
  prompt_ = centre_ = 0.0;
}

std::int64_t SampleGrid::missing_before(const std::deque<ImuSample>& held, bool no_more) const {
  const double period = running_period();
  // The delay of the held samples in periods, if none were missing.
  const auto delay = [&](std::size_t i) {
    return (static_cast<double>(held[i].stamp - origin_) - prompt_) / period - static_cast<double>(i + 1);
  };
  const double first = delay(0);
  if (first <= kLate) return 0;
  const std::size_t look = static_cast<std::size_t>(
      std::min(static_cast<double>(kLookAhead) + 2.0 * first, static_cast<double>(kLongestLook)));
  if (held.size() < look && !no_more) return kUndecided;
  double least = first;
  for (std::size_t i = 1; i < std::min(held.size(), look); ++i) least = std::min(least, delay(i));
  return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor(least + 1.0 - kLate)));
}

void SampleGrid::take(TimeNs stamp, std::int64_t missing) {
  const double period = running_period(), advance = static_cast<double>(missing + 1) * period;
  const double since = static_cast<double>(stamp - origin_);
  prompt_ += advance;
  prompt_ += std::min(since - prompt_, kPromptDrift * period);
  centre_ += advance;
  const double scatter = since - centre_;
  centre_ += kCentreGain * scatter;
  sum_of_squares_ += scatter * scatter;
  ++scattered_;
  time_ += stamp - last_;
  steps_ += missing + 1;
  last_ = stamp;
}

double SampleGrid::running_period() const {
  return (kGuessWeight * guess_ + static_cast<double>(time_)) / (kGuessWeight + static_cast<double>(steps_));
}

double SampleGrid::period() const {
  return steps_ > 0 ? static_cast<double>(time_) / static_cast<double>(steps_) : guess_;
}

double SampleGrid::jitter() const {
  if (scattered_ == 0) return 0.0;
  // The centre follows the scatter itself a little, which adds this much to what is seen.
  constexpr double kExcess = 1.0 + kCentreGain / (2.0 - kCentreGain);
  return 1e-9 * std::sqrt(sum_of_squares_ / static_cast<double>(scattered_) / kExcess);
}

}  // namespace allan_lio
