// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "lidar_probe.h"

#include <algorithm>

#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/raw_cloud.h"
#include "lidar_model.h"

namespace allan_lio {
namespace {

constexpr double kAnyRange = 1e6;  // [m]: the range limits are the configuration's business
constexpr double kTurn = 1.0;      // [s]

LioConfig::Lidar way(bool deskew, PointTime point_time) {
  LioConfig::Lidar options{};
  options.deskew = deskew;
  options.point_time = point_time;
  options.drop_tagged = true;
  options.max_range = kAnyRange;
  return options;
}

template <class T>
double median(std::vector<T> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

LidarProbe::LidarProbe(const BagConnection& connection) {
  report_.topic = connection.topic;
  report_.datatype = connection.datatype;
}

void LidarProbe::add(const BagMessage& message) {
  if (messages_++ == 0) report_.model = guess_lidar_model(message);
  if (decoder_) return take(message);
  kept_.push_back(message);
  if (kept_.size() == kTrials) choose_way();
}

void LidarProbe::choose_way() {
  const std::pair<bool, PointTime> ways[] = {
      {true, PointTime::kAuto}, {true, PointTime::kStart}, {false, PointTime::kAuto}};
  for (const auto& [deskew, point_time] : ways) {
    CloudDecoder trial(way(deskew, point_time));
    std::size_t decoded = 0;
    for (const BagMessage& message : kept_) {
      const DecodedCloud cloud = trial.decode(to_raw_cloud(message));
      if (cloud.scan) ++decoded;
      if (!cloud.scan && report_.refusal.empty()) report_.refusal = cloud.error;
    }
    report_.deskew = deskew;
    report_.point_time = point_time;
    if (2 * decoded > kept_.size()) break;
  }
  if (!report_.deskew) report_.turn = find_turn();
  decoder_ = std::make_unique<CloudDecoder>(way(report_.deskew, report_.point_time));
  for (const BagMessage& message : kept_) take(message);
  kept_.clear();
}

PointTime LidarProbe::find_turn() const {
  for (const PointTime direction : {PointTime::kAzimuthClockwise, PointTime::kAzimuthCounterclockwise}) {
    LioConfig::Lidar options = way(true, direction);
    options.turn_time = kTurn;
    CloudDecoder trial(options);
    std::size_t turned = 0;
    for (const BagMessage& message : kept_) {
      const DecodedCloud cloud = trial.decode(to_raw_cloud(message));
      if (cloud.scan && seconds_between(cloud.scan->begin(), cloud.scan->end()) > 0.5 * kTurn) ++turned;
    }
    if (2 * turned > kept_.size()) return direction;
  }
  return PointTime::kAuto;
}

void LidarProbe::take(const BagMessage& message) {
  const RawCloud raw = to_raw_cloud(message);
  const std::optional<TimeNs> stamp = stamp_of(raw);
  if (stamp) stamps_.push_back(*stamp);
  report_.frames.insert(frame_of(raw));
  const DecodedCloud cloud = decoder_->decode(raw);
  if (!cloud.scan) {
    ++report_.undecodable;
    report_.refusal = cloud.error;
    return;
  }
  delays_.push_back(to_time_ns(message.time) - cloud.scan->end());
  sweeps_.push_back(cloud.scan->end() - cloud.scan->begin());
  points_.push_back(cloud.scan->points.size());
}

SensorCheck::Lidar LidarProbe::finish() {
  if (!decoder_) choose_way();
  report_.stamps = check_stamps(stamps_);
  report_.delay = median_seconds(delays_);
  report_.sweep = median_seconds(sweeps_);
  report_.points = median(points_);
  report_.verdict = decoder_->verdict();
  report_.remarks = decoder_->remarks();
  return std::move(report_);
}

}  // namespace allan_lio
