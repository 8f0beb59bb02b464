// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "allan_lio/lidar/sweep_window.h"

namespace allan_lio {
namespace {

/// No sweep lasts longer: what lies farther from the stamp is no time [ns]. Keeps the offsets inside 32 bits.
constexpr double kFarthestOffset = 2e9;

template <class Position>
bool valid_position(Position x, Position y, Position z) {
  return std::isfinite(x) && std::isfinite(y) && std::isfinite(z) && (x != 0 || y != 0 || z != 0);
}

template <class Work>
void for_each_point(const CloudLayout& layout, Work work) {
  for (std::size_t row = 0; row < layout.rows; ++row) {
    const std::uint8_t* point = layout.data + row * layout.row_step;
    for (std::size_t column = 0; column < layout.columns; ++column, point += layout.point_step) work(point);
  }
}

/// Bits 4 and 5 of Livox's tag: 0 and 1 are good returns (first and second, or of high and middling confidence).
bool tagged_as_noise(std::uint8_t tag) { return (tag & 0x20U) != 0; }

/// Stands for the time field where there is none: every point is at the stamp.
struct NoTime {
  static constexpr bool present = false;
};
template <class T>
struct TimeOf {
  static constexpr bool present = true;
  std::size_t field_offset;
  PointTimeScale scale;
  /// False if the value is no time.
  bool operator()(const std::uint8_t* point, std::int32_t& offset_ns) const {
    const double ns = scale.offset_ns(static_cast<double>(load<T>(point + field_offset)));
    if (!(std::abs(ns) <= kFarthestOffset)) return false;
    offset_ns = static_cast<std::int32_t>(ns < 0 ? ns - 0.5 : ns + 0.5);
    return true;
  }
};

template <class Position, class Time>
DroppedPoints read_points(const CloudLayout& layout, const PointLimits& limits, const Time& time, Scan& scan) {
  DroppedPoints dropped;
  const bool tags = limits.drop_tagged && layout.tag.has_value();
  scan.points.reserve(layout.points());
  std::int32_t first = std::numeric_limits<std::int32_t>::max(), last = std::numeric_limits<std::int32_t>::min();
  for_each_point(layout, [&](const std::uint8_t* point) {
    std::int32_t offset_ns = 0;
    bool timed = true;
    if constexpr (Time::present) timed = time(point, offset_ns);
    if (timed) {
      first = std::min(first, offset_ns);
      last = std::max(last, offset_ns);
    }
    const auto x = load<Position>(point + layout.x.offset);
    const auto y = load<Position>(point + layout.y.offset);
    const auto z = load<Position>(point + layout.z.offset);
    const bool valid = valid_position(x, y, z);
    const bool noise = tags && tagged_as_noise(point[layout.tag->offset]);
    if (!timed || !valid || noise) {
      ++scan.dropped_invalid;
      if (valid && !timed) ++dropped.time;
      if (valid && timed) ++dropped.tag;
      return;
    }
    const float fx = static_cast<float>(x), fy = static_cast<float>(y), fz = static_cast<float>(z);
    const float squared = fx * fx + fy * fy + fz * fz;
    if (!(squared >= limits.smallest_squared && squared <= limits.largest_squared)) {
      ++scan.dropped_range;
      return;
    }
    float intensity = 0.0F;
    if (layout.intensity)
      intensity = static_cast<float>(load_number(point + layout.intensity->offset, layout.intensity->type));
    if (!std::isfinite(intensity)) intensity = 0.0F;
    scan.points.push_back({fx, fy, fz, intensity, offset_ns});
  });
  if (first <= last) {
    scan.first_offset_ns = first;
    scan.last_offset_ns = last;
  }
  return dropped;
}

template <class Time>
DroppedPoints read_points_at(const CloudLayout& layout, const PointLimits& limits, const Time& time, Scan& scan) {
  if (layout.x.type == NumberType::kFloat64) return read_points<double>(layout, limits, time, scan);
  return read_points<float>(layout, limits, time, scan);
}

}  // namespace

PointTimeEvidence gather_evidence(const CloudLayout& layout, TimeNs stamp) {
  PointTimeEvidence evidence;
  evidence.field = layout.time->name;
  evidence.type = layout.time->type;
  evidence.stamp = stamp;
  evidence.unit = layout.time_unit;
  std::vector<double> times;
  for_each_point(layout, [&](const std::uint8_t* point) {
    const double time = load_number(point + layout.time->offset, layout.time->type);
    if (!std::isfinite(time) || !valid_position(load_number(point + layout.x.offset, layout.x.type),
                                                load_number(point + layout.y.offset, layout.y.type),
                                                load_number(point + layout.z.offset, layout.z.type)))
      return;
    times.push_back(time);
  });
  evidence.points = times.size();
  if (times.empty()) return evidence;
  const Extent extent = extent_without_strays(times);
  evidence.smallest = extent.smallest;
  evidence.largest = extent.largest;
  return evidence;
}

DroppedPoints read_timed(const CloudLayout& layout, const PointLimits& limits, const PointTimeScale& scale,
                         Scan& scan) {
  const std::size_t at = layout.time->offset;
  switch (layout.time->type) {
    case NumberType::kInt8:
      return read_points_at(layout, limits, TimeOf<std::int8_t>{at, scale}, scan);
    case NumberType::kUint8:
      return read_points_at(layout, limits, TimeOf<std::uint8_t>{at, scale}, scan);
    case NumberType::kInt16:
      return read_points_at(layout, limits, TimeOf<std::int16_t>{at, scale}, scan);
    case NumberType::kUint16:
      return read_points_at(layout, limits, TimeOf<std::uint16_t>{at, scale}, scan);
    case NumberType::kInt32:
      return read_points_at(layout, limits, TimeOf<std::int32_t>{at, scale}, scan);
    case NumberType::kUint32:
      return read_points_at(layout, limits, TimeOf<std::uint32_t>{at, scale}, scan);
    case NumberType::kFloat32:
      return read_points_at(layout, limits, TimeOf<float>{at, scale}, scan);
    case NumberType::kFloat64:
      return read_points_at(layout, limits, TimeOf<double>{at, scale}, scan);
    case NumberType::kInt64:
      return read_points_at(layout, limits, TimeOf<std::int64_t>{at, scale}, scan);
    case NumberType::kUint64:
      return read_points_at(layout, limits, TimeOf<std::uint64_t>{at, scale}, scan);
  }
  return {};
}

double middle_raw_time(const CloudLayout& layout) {
  constexpr std::size_t kLooks = 1000;
  const std::size_t every = std::max<std::size_t>(1, layout.points() / kLooks);
  std::vector<double> times;
  for (std::size_t i = 0; i < layout.points(); i += every) {
    const std::uint8_t* point =
        layout.data + i / layout.columns * layout.row_step + i % layout.columns * layout.point_step;
    const double raw = load_number(point + layout.time->offset, layout.time->type);
    if (std::isfinite(raw) && raw != 0.0) times.push_back(raw);
  }
  if (times.empty()) return 0.0;
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

DroppedPoints read_untimed(const CloudLayout& layout, const PointLimits& limits, Scan& scan) {
  return read_points_at(layout, limits, NoTime{}, scan);
}

}  // namespace allan_lio
