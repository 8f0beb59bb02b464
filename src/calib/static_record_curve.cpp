// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "allan_lio/calib/static_record.h"

namespace allan_lio {
namespace {

// Factors of 8 to 15 strides are frozen before every second sum is dropped: 8 an octave. What remains has at least 8
// strides to a factor, where overlapping by every sample would add nothing of note.
constexpr std::int64_t kFrozenBegin = 8, kFrozenEnd = 16;

/// From sums of `stride` samples each, spaced by 1, to samples.
AllanPoint in_samples(AllanPoint point, std::int64_t stride) {
  const auto s = static_cast<double>(stride);
  point.m *= stride;
  point.variance /= s * s;
  point.record_time *= s;
  point.slide_time *= s;
  return point;
}

/// The point with the factor nearest to m.
const AllanPoint& nearest(const AllanCurve& curve, std::int64_t m) {
  const auto nearer = [m](const AllanPoint& a, const AllanPoint& b) { return std::abs(a.m - m) < std::abs(b.m - m); };
  return *std::min_element(curve.begin(), curve.end(), nearer);
}

}  // namespace

void StaticRecord::decimate() {
  freeze();
  for (IntegratedSeries& series : series_) {
    std::vector<std::size_t> starts;
    std::size_t to = 0;
    for (std::size_t piece = 0; piece < series.starts.size(); ++piece) {
      const bool last = piece + 1 == series.starts.size();
      const std::size_t begin = series.starts[piece], end = last ? series.x.size() : series.starts[piece + 1];
      if (!last && end - begin <= 4) continue;  // two sums would remain, and a variance needs three
      starts.push_back(to);
      for (std::size_t from = begin; from < end; from += 2) series.x[to++] = series.x[from];
    }
    series.x.resize(to);
    series.starts = starts;
  }
  stride_ *= 2;
}

/// The Allan variances of the factors that series_ will not give after the next decimation.
void StaticRecord::freeze() {
  std::vector<std::int64_t> factors;
  for (std::int64_t m = stride_ == 1 ? 1 : kFrozenBegin; m < kFrozenEnd; ++m) factors.push_back(m);
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    for (const AllanPoint& point : overlapping_allan_variance(series_[axis], factors, options_.threads))
      frozen_[axis].push_back(in_samples(point, stride_));
  }
}

std::int64_t StaticRecord::longest_piece() const {
  std::size_t longest = 0;
  const IntegratedSeries& series = series_[0];
  for (std::size_t i = 0; i < series.starts.size(); ++i) {
    const std::size_t end = i + 1 < series.starts.size() ? series.starts[i + 1] : series.x.size();
    longest = std::max(longest, end - series.starts[i]);
  }
  return longest > 0 ? stride_ * static_cast<std::int64_t>(longest - 1) : 0;
}

AllanCurve StaticRecord::curve(int axis, int per_decade, int threads) const {
  const auto index = static_cast<std::size_t>(axis);
  const AllanCurve& frozen = frozen_.at(index);
  const std::int64_t least = stride_ == 1 ? 1 : kFrozenBegin;  // strides to a factor that series_ still gives
  AllanCurve curve;
  std::vector<std::int64_t> factors;
  for (const std::int64_t m : log_spaced_factors(longest_piece() / 3, per_decade)) {
    if (m >= least * stride_) {
      const std::int64_t kept = (m + stride_ / 2) / stride_;
      if (factors.empty() || kept > factors.back()) factors.push_back(kept);
    } else if (!frozen.empty()) {
      const AllanPoint& point = nearest(frozen, m);
      if (curve.empty() || point.m > curve.back().m) curve.push_back(point);
    }
  }
  for (const AllanPoint& point : overlapping_allan_variance(series_[index], factors, threads))
    curve.push_back(in_samples(point, stride_));
  for (AllanPoint& point : curve) {
    point.tau = static_cast<double>(point.m) * tau0();
    point.variance *= units_[index] * units_[index];
    point.record_time *= tau0();
    point.slide_time *= tau0();
  }
  return curve;
}

IntegratedSeries StaticRecord::series(int axis) const {
  const auto index = static_cast<std::size_t>(axis);
  IntegratedSeries series = series_.at(index);
  series.tau0 = static_cast<double>(stride_) * tau0();
  const double scale = units_[index] * tau0();
  for (double& x : series.x) x *= scale;
  return series;
}

}  // namespace allan_lio
