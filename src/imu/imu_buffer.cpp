// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_buffer.h"

#include <algorithm>

namespace allan_lio {
namespace {

bool earlier(const ImuSample& sample, TimeNs t) { return sample.stamp < t; }

}  // namespace

bool ImuBuffer::push(const ImuSample& sample) {
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) return false;
  samples_.push_back(sample);
  return true;
}

ImuSample ImuBuffer::at(TimeNs t) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), t, earlier);
  ImuSample reading;
  if (after == samples_.begin() || after == samples_.end()) {
    reading = after == samples_.begin() ? samples_.front() : samples_.back();
  } else {
    const ImuSample& a = *(after - 1);
    const ImuSample& b = *after;
    const double s = seconds_between(a.stamp, t) / seconds_between(a.stamp, b.stamp);
    reading.gyro = a.gyro + s * (b.gyro - a.gyro);
    reading.accel = a.accel + s * (b.accel - a.accel);
  }
  reading.stamp = t;
  return reading;
}

std::vector<ImuSample> ImuBuffer::between(TimeNs from, TimeNs to) const {
  std::vector<ImuSample> out{at(from)};
  auto it = std::lower_bound(samples_.begin(), samples_.end(), from + 1, earlier);
  for (; it != samples_.end() && it->stamp < to; ++it) out.push_back(*it);
  out.push_back(at(to));
  return out;
}

double ImuBuffer::longest_gap(TimeNs from, TimeNs to) const {
  double longest = 0.0;
  auto it = std::lower_bound(samples_.begin(), samples_.end(), from + 1, earlier);
  for (; it != samples_.end() && it->stamp <= to; ++it)
    if (it != samples_.begin()) longest = std::max(longest, seconds_between((it - 1)->stamp, it->stamp));
  return longest;
}

ImuBuffer::Silence ImuBuffer::longest_silence(TimeNs from, TimeNs to) const {
  Silence longest;
  for (auto it = std::lower_bound(samples_.begin(), samples_.end(), from + 1, earlier); it != samples_.end(); ++it) {
    if (it == samples_.begin()) continue;
    const TimeNs begin = std::max((it - 1)->stamp, from);
    const double seconds = seconds_between(begin, std::min(it->stamp, to));
    if (seconds > longest.seconds) longest = {seconds, begin, it->stamp};
    if (it->stamp >= to) break;
  }
  return longest;
}

double ImuBuffer::spacing_at(TimeNs t) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), t, earlier);
  if (after == samples_.begin() || after == samples_.end()) return 0.0;
  return seconds_between((after - 1)->stamp, after->stamp);
}

void ImuBuffer::discard_before(TimeNs t) {
  while (samples_.size() > 1 && samples_[1].stamp <= t) samples_.pop_front();
}

}  // namespace allan_lio
