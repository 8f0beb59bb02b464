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
constexpr const char* kTimeFields[] = {"", "time", "t", "timestamp", "intensity", "x", "ring", "no such field"};

/// `times`: the unit and the field of the points' times.
LioConfig::Lidar options(std::uint8_t choice, std::uint8_t times) {
  LioConfig::Lidar lidar{};
  lidar.deskew = (choice & 1U) == 0;
  lidar.point_time = static_cast<PointTime>((choice >> 1U) & 3U);
  lidar.drop_tagged = (choice & 8U) == 0;
  lidar.time_unit = static_cast<TimeUnit>(times % kUnits);
  lidar.time_field = kTimeFields[times / kUnits % std::size(kTimeFields)];
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
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const auto choice = input.take<std::uint8_t>();
  const LioConfig::Lidar lidar = options(choice, input.take<std::uint8_t>());
  const bool whole = holds_point_cloud(input.data(), input.size());
  if (!whole) return 0;
  sensor_msgs::PointCloud2 cloud;
  ros::serialization::IStream stream(const_cast<std::uint8_t*>(input.data()), static_cast<std::uint32_t>(input.size()));
  ros::serialization::deserialize(stream, cloud);  // must not throw: holds_point_cloud() has said so
  CloudDecoder decoder(lidar);
  for (int again = 0; again < 2; ++again) {
    const DecodedCloud decoded = decoder.decode(cloud);
    must(decoded.scan.has_value() == decoded.error.empty());
    if (decoded.scan) check(*decoded.scan, lidar);
  }
  return 0;
}
