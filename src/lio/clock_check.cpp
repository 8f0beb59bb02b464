// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/clock_check.h"

#include <algorithm>
#include <cstdio>

namespace allan_lio {

void ClockCheck::Range::add(TimeNs stamp) {
  begin = count == 0 ? stamp : std::min(begin, stamp);
  end = count == 0 ? stamp : std::max(end, stamp);
  ++count;
}

std::string ClockCheck::trouble() const {
  if (imu_.count == 0 || lidar_.count < kScans) return "";
  if (imu_.seconds() < kEnough || lidar_.seconds() < kEnough) return "";
  const double lidar_behind = seconds_between(lidar_.end, imu_.begin), ahead = seconds_between(imu_.end, lidar_.begin);
  if (std::max(lidar_behind, ahead) < kApart) return "";
  const auto seconds = [](TimeNs t) { return 1e-9 * static_cast<double>(t); };
  char text[400];
  std::snprintf(
      text, sizeof text,
      "LiDAR and IMU go by different clocks: the IMU's stamps run from %.3f to %.3f s, the LiDAR's from %.3f to "
      "%.3f s; synchronise them (PTP or the driver's time source), or correct less than 1 s by "
      "lidar/time_offset",
      seconds(imu_.begin), seconds(imu_.end), seconds(lidar_.begin), seconds(lidar_.end));
  return text;
}

}  // namespace allan_lio
