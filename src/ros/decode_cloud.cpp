// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/decode_cloud.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "allan_lio/ros/cloud_wire.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/livox_custom.h"

namespace allan_lio {
namespace {

using Origin = PointTimeRule::Origin;

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

PointTimeEvidence gather_evidence(const CloudLayout& layout, TimeNs stamp) {
  PointTimeEvidence evidence;
  evidence.field = layout.time->name;
  evidence.type = layout.time->type;
  evidence.stamp = stamp;
  double smallest = std::numeric_limits<double>::infinity(), largest = -smallest;
  for_each_point(layout, [&](const std::uint8_t* point) {
    const double time = load_number(point + layout.time->offset, layout.time->type);
    if (!std::isfinite(time) || !valid_position(load_number(point + layout.x.offset, layout.x.type),
                                                load_number(point + layout.y.offset, layout.y.type),
                                                load_number(point + layout.z.offset, layout.z.type)))
      return;
    smallest = std::min(smallest, time);
    largest = std::max(largest, time);
    ++evidence.points;
  });
  if (evidence.points > 0) {
    evidence.smallest = smallest;
    evidence.largest = largest;
  }
  return evidence;
}

struct RangeLimits {
  float smallest_squared, largest_squared;  ///< [m^2]
};

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
void read_points(const CloudLayout& layout, const RangeLimits& limits, const Time& time, Scan& scan) {
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
    if (!timed || !valid_position(x, y, z)) {
      ++scan.dropped_invalid;
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
}

template <class Time>
void read_points_at(const CloudLayout& layout, const RangeLimits& limits, const Time& time, Scan& scan) {
  if (layout.x.type == NumberType::kFloat64) return read_points<double>(layout, limits, time, scan);
  read_points<float>(layout, limits, time, scan);
}

void read_timed(const CloudLayout& layout, const RangeLimits& limits, const PointTimeScale& scale, Scan& scan) {
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
  }
}

/// Any valid raw time of the cloud, 0 if there is none.
double any_raw_time(const CloudLayout& layout) {
  for (std::size_t row = 0; row < layout.rows; ++row) {
    for (std::size_t column = 0; column < layout.columns; ++column) {
      const std::uint8_t* point = layout.data + row * layout.row_step + column * layout.point_step;
      const double raw = load_number(point + layout.time->offset, layout.time->type);
      if (std::isfinite(raw) && raw != 0.0) return raw;
    }
  }
  return 0.0;
}

/// Shifts the offsets so that the smallest (or the largest) is at the stamp.
void move_to_stamp(Origin origin, Scan& scan) {
  if (origin != Origin::kSweepStart && origin != Origin::kSweepEnd) return;
  const std::int32_t zero = origin == Origin::kSweepStart ? scan.first_offset_ns : scan.last_offset_ns;
  // Two offsets of +-2 s can differ by more than 32 bits hold; such a scan is garbage, and saturates.
  const auto moved = [zero](std::int32_t offset) {
    const std::int64_t wide = std::int64_t{offset} - zero;
    constexpr auto kLimit = static_cast<std::int64_t>(kFarthestOffset);
    return static_cast<std::int32_t>(std::clamp(wide, -kLimit, kLimit));
  };
  for (ScanPoint& point : scan.points) point.offset_ns = moved(point.offset_ns);
  scan.first_offset_ns = moved(scan.first_offset_ns);
  scan.last_offset_ns = moved(scan.last_offset_ns);
}

std::string missing_time(const sensor_msgs::PointCloud2& cloud, const std::string& time_field) {
  std::string names;
  for (const auto& field : cloud.fields) names += (names.empty() ? "" : ", ") + field.name;
  const std::string wanted = time_field.empty() ? "no field for the points' times" : "no field '" + time_field + "'";
  return "the cloud has " + wanted + " (fields: " + names +
         "); name it in lidar/time_field, or set lidar/deskew: false";
}

}  // namespace

CloudDecoder::CloudDecoder(const LioConfig::Lidar& options) : options_(options), detector_(options) {}

DecodedCloud CloudDecoder::decode(const sensor_msgs::PointCloud2& cloud) {
  DecodedCloud decoded;
  const std::optional<CloudLayout> layout = read_layout(cloud, options_.time_field, decoded.error);
  if (!layout) return decoded;
  if (options_.deskew && layout->points() > 0 && !layout->time) {
    decoded.error = missing_time(cloud, options_.time_field);
    return decoded;
  }
  return decode(*layout, to_time_ns(cloud.header.stamp));
}

DecodedCloud CloudDecoder::decode(const RawCloud& cloud) {
  DecodedCloud decoded;
  const std::optional<CloudKind> kind = cloud_kind(cloud, decoded.error);
  if (!kind) return decoded;
  if (*kind == CloudKind::kLivoxCustom) {
    const std::optional<LivoxCustom> livox = read_livox_custom(cloud.bytes, cloud.size, decoded.error);
    return livox ? decode(livox->layout, livox->stamp) : decoded;
  }
  if (!holds_point_cloud(cloud.bytes, cloud.size)) {
    decoded.error = "the cloud's " + std::to_string(cloud.size) + " bytes end before what its lengths announce";
    return decoded;
  }
  sensor_msgs::PointCloud2 message;
  // IStream takes a pointer to non-const although it only reads.
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(cloud.bytes), static_cast<std::uint32_t>(cloud.size));
  ros::serialization::deserialize(stream, message);
  return decode(message);
}

DecodedCloud CloudDecoder::decode(const CloudLayout& layout, TimeNs stamp) {
  DecodedCloud decoded;
  Scan scan;
  scan.stamp = stamp + to_ns(options_.time_offset);
  const RangeLimits limits{static_cast<float>(options_.min_range * options_.min_range),
                           static_cast<float>(options_.max_range * options_.max_range)};
  if (!options_.deskew) {
    read_points_at(layout, limits, NoTime{}, scan);
  } else if (layout.points() > 0) {
    if (!detector_.settled()) detector_.examine(gather_evidence(layout, stamp));
    if (!detector_.rule()) {
      decoded.error = detector_.refusal();
      return decoded;
    }
    const PointTimeRule& rule = *detector_.rule();
    const bool floating = rule.origin == Origin::kSweepStart || rule.origin == Origin::kSweepEnd;
    read_timed(layout, limits, PointTimeScale(rule, stamp, floating ? any_raw_time(layout) : 0.0), scan);
    move_to_stamp(rule.origin, scan);
  }
  decoded.scan = std::move(scan);
  return decoded;
}

std::string CloudDecoder::verdict() const {
  if (!options_.deskew) return "point time: not read, every point counts at its scan's stamp (lidar/deskew: false)";
  if (detector_.rule()) return detector_.rule()->verdict;
  return detector_.refusal().empty() ? "" : "point time: refused: " + detector_.refusal();
}

}  // namespace allan_lio
