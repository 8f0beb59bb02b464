// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/static_record.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr std::size_t kStartSamples = 257;  // from which the period is guessed
constexpr int kClockSetBack = 16;           // backward stamps in a row that are no accident any more
constexpr std::size_t kLeastRoom = 64;

bool is_finite(const ImuSample& sample) { return sample.gyro.allFinite() && sample.accel.allFinite(); }

}  // namespace

StaticRecord::StaticRecord(const StaticRecordOptions& options) : options_(options) {
  if (!(options.rate >= 0.0) || !std::isfinite(options.rate))
    throw std::invalid_argument("static record: the rate must be positive and finite");
  if (options.max_samples < kLeastRoom)
    throw std::invalid_argument("static record: there must be room for " + std::to_string(kLeastRoom) + " values");
  units_.fill(1.0);
  // Virtual memory only: a vector that grows would hold its values twice at times.
  for (IntegratedSeries& series : series_) series.x.reserve(options.max_samples);
  if (options.rate > 0.0) stillness_ = std::make_unique<Stillness>(1.0 / options.rate);
}

void StaticRecord::set_units(double gyro, double accel) { units_ = {gyro, gyro, gyro, accel, accel, accel}; }

void StaticRecord::add(const ImuSample& sample) {
  const bool good = is_finite(sample);
  if (!good) ++faults_.not_finite;
  if (options_.rate > 0.0) {
    good ? add_unstamped(sample) : static_cast<void>(++skipped_);
    return;
  }
  if (!good) return;
  if (has_stamp_ && sample.stamp <= last_stamp_) {
    ++faults_.backward;
    if (++backward_in_a_row_ < kClockSetBack) return;
    --faults_.backward;
    ++faults_.clock_set_back;
    settle(true);
    in_piece_ = false;
  }
  backward_in_a_row_ = 0;
  has_stamp_ = true;
  last_stamp_ = sample.stamp;
  held_.push_back(sample);
  settle(false);
}

void StaticRecord::add_unstamped(const ImuSample& sample) {
  if (!in_piece_) skipped_ = 0;
  take(sample, skipped_);
  skipped_ = 0;
}

void StaticRecord::start_grid() {
  std::vector<TimeNs> stamps;
  for (const ImuSample& sample : held_) stamps.push_back(sample.stamp);
  const double period = SampleGrid::guess_period(stamps);
  grid_ = std::make_unique<SampleGrid>(period);
  stillness_ = std::make_unique<Stillness>(1e-9 * period);
}

void StaticRecord::settle(bool no_more) {
  if (!grid_) {
    if (held_.size() < 2 || (held_.size() < kStartSamples && !no_more)) return;
    start_grid();
  }
  while (!held_.empty()) {
    const ImuSample& sample = held_.front();
    const std::int64_t missing = in_piece_ ? grid_->missing_before(held_, no_more) : 0;
    if (missing == SampleGrid::kUndecided) return;
    const bool new_piece = !in_piece_ || missing > kLongestBridge;
    take(sample, missing);
    new_piece ? grid_->begin_piece(sample.stamp) : grid_->take(sample.stamp, missing);
    held_.pop_front();
  }
}

void StaticRecord::finish() {
  if (options_.rate == 0.0) settle(true);
}

/// Straight lines over short gaps, a new piece after long ones.
void StaticRecord::take(const ImuSample& sample, std::int64_t missing) {
  const double interval = options_.rate > 0.0 ? 1.0 / options_.rate : 1e-9 * grid_->period();
  Values values = {sample.gyro.x(),  sample.gyro.y(),  sample.gyro.z(),
                   sample.accel.x(), sample.accel.y(), sample.accel.z()};
  stillness_->add(values, missing);
  if (samples_ == 0) offset_ = values;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    values[axis] -= offset_[axis];
    sum_[axis] += values[axis];
    squares_[axis] += values[axis] * values[axis];
  }
  if (missing > 0) faults_.longest_gap = std::max(faults_.longest_gap, interval * static_cast<double>(missing));
  if (missing > kLongestBridge) {
    ++faults_.long_gaps;
    in_piece_ = false;
  } else if (missing > 0) {
    ++faults_.bridged_gaps;
    faults_.bridged_samples += missing;
    const Values from = previous_;
    for (std::int64_t i = 1; i <= missing; ++i) {
      const double part = static_cast<double>(i) / static_cast<double>(missing + 1);
      Values between;
      for (std::size_t axis = 0; axis < kAxes; ++axis) between[axis] = (1.0 - part) * from[axis] + part * values[axis];
      integrate(between);
    }
  }
  if (!in_piece_) begin_piece();
  integrate(values);
  previous_ = values;
  ++samples_;
}

void StaticRecord::begin_piece() {
  in_piece_ = true;
  in_this_piece_ = 0;
  integral_ = {};
  for (IntegratedSeries& series : series_) series.starts.push_back(series.x.size());
  keep();
}

void StaticRecord::integrate(const Values& values) {
  for (std::size_t axis = 0; axis < kAxes; ++axis) integral_[axis] += values[axis];
  ++steps_;
  if (++in_this_piece_ % stride_ == 0) keep();
}

void StaticRecord::keep() {
  for (std::size_t axis = 0; axis < kAxes; ++axis) series_[axis].x.push_back(integral_[axis]);
  if (series_[0].x.size() == options_.max_samples) decimate();
}

double StaticRecord::tau0() const {
  if (options_.rate > 0.0) return 1.0 / options_.rate;
  return grid_ ? 1e-9 * grid_->period() : 0.0;
}

double StaticRecord::duration() const { return static_cast<double>(steps_) * tau0(); }

double StaticRecord::mean(int axis) const {
  const auto i = static_cast<std::size_t>(axis);
  return units_[i] * (offset_[i] + (samples_ > 0 ? sum_[i] / static_cast<double>(samples_) : 0.0));
}

double StaticRecord::deviation(int axis) const {
  if (samples_ < 2) return 0.0;
  const auto i = static_cast<std::size_t>(axis);
  const auto n = static_cast<double>(samples_);
  return units_[i] * std::sqrt(std::max(0.0, (squares_[i] - sum_[i] * sum_[i] / n) / (n - 1.0)));
}

double StaticRecord::jitter() const { return grid_ ? grid_->jitter() : 0.0; }

std::string StaticRecord::motion() const { return stillness_ ? stillness_->warning(units_) : ""; }

}  // namespace allan_lio
