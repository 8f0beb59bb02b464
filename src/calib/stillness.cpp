// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/stillness.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kFarAbove = 3.0;       // times the median's scatter
constexpr double kRestlessGyro = 0.1;   // scatter of the readings that no gyro at rest has [rad/s]
constexpr double kRestlessAccel = 1.0;  // the same of an accelerometer [m/s^2]
constexpr double kTurn = 0.02;          // mean rate off the median by more than bias drift can be [rad/s]

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

Stillness::Stillness(double period)
    : period_(period), length_(std::max<std::int64_t>(16, std::llround(kStretch / period))) {}

void Stillness::add(const std::array<double, 6>& sample, std::int64_t missing) {
  index_ += missing;
  if (count_ == 0) {
    origin_ = sample;
    sum_ = squares_ = {};
    begin_ = index_;
  }
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double d = sample[axis] - origin_[axis];
    sum_[axis] += d;
    squares_[axis] += d * d;
  }
  ++index_;
  if (++count_ == length_) close();
}

void Stillness::close() {
  Stretch stretch{};
  stretch.begin = begin_;
  const auto n = static_cast<double>(count_);
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const double mean = sum_[axis] / n;
    stretch.mean[axis] = static_cast<float>(origin_[axis] + mean);
    stretch.deviation[axis] = static_cast<float>(std::sqrt(std::max(0.0, squares_[axis] / n - mean * mean)));
  }
  stretches_.push_back(stretch);
  count_ = 0;
}

std::string Stillness::warning(const std::array<double, 6>& units) const {
  if (stretches_.empty()) return "";
  std::vector<bool> moved(stretches_.size(), false);
  bool restless = false;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    std::vector<double> deviations, means;
    for (const Stretch& s : stretches_) {
      deviations.push_back(units[axis] * s.deviation[axis]);
      means.push_back(units[axis] * s.mean[axis]);
    }
    const double typical = median(deviations), level = median(means);
    restless = restless || typical > (axis < 3 ? kRestlessGyro : kRestlessAccel);
    for (std::size_t i = 0; i < stretches_.size(); ++i) {
      if (typical > 0.0 && deviations[i] > kFarAbove * typical) moved[i] = true;
      if (axis < 3 && std::abs(means[i] - level) > kTurn) moved[i] = true;
    }
  }
  if (restless) return "the sensor was not at rest: its readings scatter all along as under motion or strong vibration";
  const auto count = std::count(moved.begin(), moved.end(), true);
  if (count == 0) return "";
  const auto first = static_cast<std::size_t>(std::find(moved.begin(), moved.end(), true) - moved.begin());
  const auto begin = std::llround(static_cast<double>(stretches_[first].begin) * period_);
  return "the sensor was not still: in " + std::to_string(count) + " of " + std::to_string(stretches_.size()) +
         " stretches of 10 s its readings turn or scatter far above the rest, first at " + std::to_string(begin) +
         " s; the figures include them";
}

}  // namespace allan_lio
