// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Livox's CustomMsg as its bytes come from a bag or a topic. First byte: with deskew or without, with tagged points or
// without, what the times count from, and the unit that is told of them.
#include <cmath>

#include "allan_lio/ros/decode_cloud.h"
#include "allan_lio/ros/livox_custom.h"
#include "fuzz_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  constexpr unsigned kPointTimes = static_cast<unsigned>(PointTime::kAzimuthCounterclockwise) + 1;
  constexpr unsigned kUnits = static_cast<unsigned>(TimeUnit::kNanoseconds) + 1;
  FuzzInput input(data, size);
  LioConfig::Lidar lidar{};
  const std::uint8_t choice = input.take<std::uint8_t>();
  lidar.deskew = (choice & 1U) == 0;
  lidar.drop_tagged = (choice & 2U) == 0;
  lidar.point_time = static_cast<PointTime>((choice >> 2U) % kPointTimes);
  lidar.time_unit = static_cast<TimeUnit>((choice >> 2U) / kPointTimes % kUnits);
  lidar.turn_time = 0.1;
  lidar.min_range = 0.5;
  lidar.max_range = 100.0;
  const RawCloud cloud{"livox_ros_driver/CustomMsg", kLivoxCustomMd5sum, input.data(), input.size()};
  CloudDecoder decoder(lidar);
  for (int again = 0; again < 2; ++again) {
    const DecodedCloud decoded = decoder.decode(cloud);
    must(decoded.scan.has_value() == decoded.error.empty());
    if (!decoded.scan) continue;
    must(decoded.scan->first_offset_ns <= decoded.scan->last_offset_ns);
    for (const ScanPoint& p : decoded.scan->points) {
      must(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
      must(p.offset_ns >= decoded.scan->first_offset_ns && p.offset_ns <= decoded.scan->last_offset_ns);
    }
  }
  return 0;
}
