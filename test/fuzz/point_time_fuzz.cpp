// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// What one scan says about its point times, as numbers.
#include <cmath>

#include "allan_lio/lidar/point_time.h"
#include "fuzz_input.h"

namespace {

constexpr int kPointTimes = static_cast<int>(allan_lio::PointTime::kAzimuthCounterclockwise) + 1;
constexpr int kTypes = static_cast<int>(allan_lio::NumberType::kUint64);  // numbered from 1 on

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace allan_lio;
  FuzzInput input(data, size);
  LioConfig::Lidar lidar{};
  lidar.point_time = static_cast<PointTime>(input.take<std::uint8_t>() % kPointTimes);
  lidar.time_unit = static_cast<TimeUnit>(input.take<std::uint8_t>() % 5);
  PointTimeDetector detector(lidar);
  for (int i = 0; i < 3 && !detector.settled(); ++i) {
    PointTimeEvidence evidence;
    evidence.field = "time";
    evidence.type = static_cast<NumberType>(1 + input.take<std::uint8_t>() % kTypes);
    evidence.points = input.take<std::uint16_t>();
    // As a header can hold them.
    evidence.stamp = static_cast<TimeNs>(input.take<std::uint32_t>()) * kNsPerSecond + input.take<std::uint32_t>();
    evidence.smallest = input.take<double>();
    evidence.largest = input.take<double>();
    if (!(evidence.smallest <= evidence.largest) || !std::isfinite(evidence.smallest) ||
        !std::isfinite(evidence.largest))
      return 0;  // CloudDecoder gathers finite numbers only
    detector.examine(evidence);
    must(detector.rule().has_value() == detector.refusal().empty());
    if (!detector.rule()) continue;
    const PointTimeRule& rule = *detector.rule();
    must(rule.ns_per_unit > 0.0 && !rule.verdict.empty());
    const PointTimeScale scale(rule, evidence.stamp, evidence.smallest);
    must(scale.offset_ns(evidence.smallest) <= scale.offset_ns(evidence.largest));
  }
  return 0;
}
