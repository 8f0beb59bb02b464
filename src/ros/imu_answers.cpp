// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/imu_answers.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kGap = 1.5;  // intervals between two stamps from which a sample is missing

}  // namespace

void ImuAnswers::saw_odometry(const ros::Time& stamp) {
  if (!last_.isZero()) {
    const ros::Duration step = stamp - last_;
    interval_ = interval_.isZero() ? step : std::min(interval_, step);
    if (step > interval_ * kGap) gaps_.emplace_back(last_, stamp);
  }
  last_ = stamp;
}

ImuAnswers::Missing ImuAnswers::missing() const {
  Missing missing;
  for (const auto& [before, after] : gaps_) {
    const auto newer = std::lower_bound(states_.begin(), states_.end(), after - interval_ * kGap);
    const bool superseded = newer != states_.end() && *newer < after;
    const double samples = (after - before).toSec() / interval_.toSec() - 1.0;
    (superseded ? missing.superseded : missing.lost) += static_cast<std::uint64_t>(std::lround(samples));
  }
  return missing;
}

}  // namespace allan_lio
