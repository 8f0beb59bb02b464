// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/decode_cloud.h"

#include <algorithm>

#include "allan_lio/lidar/sweep_window.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/livox_custom.h"
#include "point_reader.h"

namespace allan_lio {
namespace {

using Origin = PointTimeRule::Origin;

/// Two offsets of +-2 s can differ by more than 32 bits hold; such a scan is garbage, and saturates [ns].
constexpr std::int64_t kFarthestOffset = 2'000'000'000;

/// Shifts the offsets so that the smallest (or the largest) is at the stamp.
void move_to_stamp(Origin origin, Scan& scan) {
  if (origin != Origin::kSweepStart && origin != Origin::kSweepEnd) return;
  const std::int32_t zero = origin == Origin::kSweepStart ? scan.first_offset_ns : scan.last_offset_ns;
  const auto moved = [zero](std::int32_t offset) {
    const std::int64_t wide = std::int64_t{offset} - zero;
    return static_cast<std::int32_t>(std::clamp(wide, -kFarthestOffset, kFarthestOffset));
  };
  for (ScanPoint& point : scan.points) point.offset_ns = moved(point.offset_ns);
  scan.first_offset_ns = moved(scan.first_offset_ns);
  scan.last_offset_ns = moved(scan.last_offset_ns);
}

PointLimits limits_of(const LioConfig::Lidar& options) {
  return {static_cast<float>(options.min_range * options.min_range),
          static_cast<float>(options.max_range * options.max_range), options.drop_tagged};
}

std::string missing_time(const sensor_msgs::PointCloud2& cloud, const std::string& time_field) {
  std::string names;
  for (const auto& field : cloud.fields) names += (names.empty() ? "" : ", ") + field.name;
  const std::string wanted = time_field.empty() ? "no field for the points' times" : "no field '" + time_field + "'";
  return "the cloud has " + wanted + " (fields: " + names +
         "); name it in lidar/time_field, set lidar/point_time: azimuth_clockwise if the LiDAR spins and its points "
         "come "
         "in the order of firing, or set lidar/deskew: false";
}

std::optional<LidarTurn> turn_of(const LioConfig::Lidar& options) {
  const bool clockwise = options.point_time == PointTime::kAzimuthClockwise;
  if (!options.deskew || (!clockwise && options.point_time != PointTime::kAzimuthCounterclockwise)) return {};
  return LidarTurn{clockwise, options.turn_time};
}

}  // namespace

CloudDecoder::CloudDecoder(const LioConfig::Lidar& options)
    : options_(options), turn_(turn_of(options)), detector_(options) {}

DecodedCloud CloudDecoder::decode(const sensor_msgs::PointCloud2& cloud) { return decode(view_of(cloud)); }

DecodedCloud CloudDecoder::decode(const CloudView& cloud) {
  DecodedCloud decoded;
  const std::optional<CloudLayout> layout = read_layout(cloud, options_.time_field, decoded.error);
  if (!layout) return decoded;
  if (options_.deskew && !turn_ && layout->points() > 0 && !layout->time) {
    decoded.error = missing_time(cloud.head, options_.time_field);
    return decoded;
  }
  return decode(*layout, to_time_ns(cloud.head.header.stamp));
}

DecodedCloud CloudDecoder::decode(const RawCloud& cloud) {
  DecodedCloud decoded;
  const std::optional<CloudKind> kind = cloud_kind(cloud, decoded.error);
  if (!kind) return decoded;
  if (*kind == CloudKind::kLivoxCustom) {
    const std::optional<LivoxCustom> livox = read_livox_custom(cloud.bytes, cloud.size, decoded.error);
    return livox ? decode(livox->layout, livox->stamp) : decoded;
  }
  const std::optional<CloudView> view = read_point_cloud(cloud.bytes, cloud.size);
  if (view) return decode(*view);
  decoded.error = "the cloud's " + std::to_string(cloud.size) + " bytes end before what its lengths announce";
  return decoded;
}

DecodedCloud CloudDecoder::decode(const CloudLayout& layout, TimeNs stamp) {
  DecodedCloud decoded;
  Scan scan;
  scan.stamp = stamp + to_ns(options_.time_offset);
  if (!options_.deskew || turn_) {
    tagged_noise_ += read_untimed(layout, limits_of(options_), scan).tag;
    if (turn_) decoded.error = set_times_by_azimuth(*turn_, scan);
    if (!decoded.error.empty()) return decoded;
  } else if (layout.points() > 0) {
    if (!detector_.settled()) detector_.examine(gather_evidence(layout, stamp));
    if (!detector_.rule()) {
      decoded.error = detector_.refusal();
      return decoded;
    }
    decoded.error = read_by_rule(layout, stamp, scan);
    if (!decoded.error.empty()) return decoded;
  }
  decoded.scan = std::move(scan);
  return decoded;
}

std::string CloudDecoder::read_by_rule(const CloudLayout& layout, TimeNs stamp, Scan& scan) {
  const PointTimeRule& rule = *detector_.rule();
  const bool floating = rule.origin == Origin::kSweepStart || rule.origin == Origin::kSweepEnd;
  const PointTimeScale scale(rule, stamp, floating ? middle_raw_time(layout) : 0.0);
  DroppedPoints dropped = read_timed(layout, limits_of(options_), scale, scan);
  tagged_noise_ += dropped.tag;

  if (sweep_ns_ == 0.0) sweep_ns_ = 1e9 * rule.sweep;
  const auto length = [&scan] { return static_cast<double>(scan.last_offset_ns) - scan.first_offset_ns; };
  std::optional<std::size_t> strays = 0;
  if (length() > SweepWindow::kStretch * sweep_ns_) strays = drop_strays(scan, sweep_ns_);
  const std::size_t timed = scan.points.size();
  if (strays) dropped.time += *strays, scan.dropped_invalid += static_cast<std::uint32_t>(*strays);
  wild_times_ += dropped.time;
  if (!strays ||
      static_cast<double>(dropped.time) > SweepWindow::kMostStrays * static_cast<double>(timed + dropped.time))
    return "field '" + layout.time->name + "': too many of the scan's " + std::to_string(layout.points()) +
           " points have a time outside of its sweep";
  if (length() > 0.0) sweep_ns_ = length();
  move_to_stamp(rule.origin, scan);
  return "";
}

std::string CloudDecoder::verdict() const {
  if (!options_.deskew) return "point time: not read, every point counts at its scan's stamp (lidar/deskew: false)";
  if (turn_) return "point time: made from the azimuth, from the header stamp on (lidar/point_time)";
  if (detector_.rule()) return detector_.rule()->verdict;
  return detector_.refusal().empty() ? "" : "point time: refused: " + detector_.refusal();
}

std::vector<std::string> CloudDecoder::remarks() const {
  std::vector<std::string> sentences;
  const auto note = [&sentences](std::uint64_t count, const char* why) {
    if (count > 0) sentences.push_back(std::to_string(count) + " points were dropped " + why);
  };
  note(wild_times_, "because their time lies outside of their scan's sweep");
  note(tagged_noise_, "because the LiDAR tagged them as noise (lidar/drop_tagged)");
  return sentences;
}

}  // namespace allan_lio
