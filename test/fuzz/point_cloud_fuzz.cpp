// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// sensor_msgs/PointCloud2 as its bytes come from a bag or a topic. First two bytes: which of the options.
#include <cmath>
#include <iterator>

#include "allan_lio/ros/cloud_wire.h"
#include "allan_lio/ros/decode_cloud.h"
#include "fuzz_input.h"

namespace {

using namespace allan_lio;

constexpr unsigned kUnits = static_cast<unsigned>(TimeUnit::kNanoseconds) + 1;
constexpr unsigned kPointTimes = static_cast<unsigned>(PointTime::kAzimuthCounterclockwise) + 1;
constexpr double kTurnTimes[] = {0.1, 0.01, 0.05, 1.0};  // [s]
constexpr const char* kTimeFields[] = {"", "time", "t", "timestamp", "intensity", "x", "ring", "no such field"};

/// `times`: the unit and the field of the points' times, and a spinning LiDAR's turn.
LioConfig::Lidar options(std::uint8_t choice, std::uint8_t times) {
  LioConfig::Lidar lidar{};
  lidar.deskew = (choice & 1U) == 0;
  lidar.drop_tagged = (choice & 2U) == 0;
  lidar.point_time = static_cast<PointTime>((choice >> 2U) % kPointTimes);
  lidar.time_unit = static_cast<TimeUnit>(times % kUnits);
  lidar.time_field = kTimeFields[times / kUnits % std::size(kTimeFields)];
  lidar.turn_time = kTurnTimes[times / kUnits / std::size(kTimeFields) % std::size(kTurnTimes)];
  lidar.min_range = 0.5;
  lidar.max_range = 100.0;
  return lidar;
}

void check(const Scan& scan, const LioConfig::Lidar& lidar) {
  must(scan.first_offset_ns <= scan.last_offset_ns);
  for (const ScanPoint& p : scan.points) {
    must(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
    must(p.offset_ns >= scan.first_offset_ns && p.offset_ns <= scan.last_offset_ns);
    must(std::hypot(p.x, p.y, p.z) < 1.001 * lidar.max_range);
  }
  const bool by_azimuth =
      lidar.point_time == PointTime::kAzimuthClockwise || lidar.point_time == PointTime::kAzimuthCounterclockwise;
  // A turn, and what its edges overlap.
  must(!lidar.deskew || !by_azimuth || scan.last_offset_ns - scan.first_offset_ns <= 1.2e9 * lidar.turn_time);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const auto choice = input.take<std::uint8_t>();
  const LioConfig::Lidar lidar = options(choice, input.take<std::uint8_t>());
  std::optional<CloudView> view = read_point_cloud(input.data(), input.size());
  if (!view) return 0;
  sensor_msgs::PointCloud2 cloud;
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(input.data()), static_cast<std::uint32_t>(input.size()));
  ros::serialization::deserialize(stream, cloud);  // must not throw: read_point_cloud() has said so
  view->head.data.assign(view->data, view->data + view->size);
  must(view->head == cloud);
  CloudDecoder of_bytes(lidar), of_message(lidar);
  const RawCloud raw{ros::message_traits::datatype<sensor_msgs::PointCloud2>(),
                     ros::message_traits::md5sum<sensor_msgs::PointCloud2>(), input.data(), input.size()};
  for (int again = 0; again < 2; ++again) {
    const DecodedCloud decoded = of_bytes.decode(raw), other = of_message.decode(cloud);
    must(decoded.scan.has_value() == decoded.error.empty());
    must(decoded.error == other.error && decoded.scan.has_value() == other.scan.has_value());
    must(!decoded.scan || decoded.scan->points.size() == other.scan->points.size());
    if (decoded.scan) check(*decoded.scan, lidar);
  }
  return 0;
}
