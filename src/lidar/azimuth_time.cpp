// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/azimuth_time.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace allan_lio {
namespace {

constexpr double kTurn = 2.0 * M_PI;        // [rad]
constexpr double kBehind = M_PI / 6.0;      // [rad] that a point may lie behind the foremost one before it
constexpr double kMost = kTurn + M_PI / 3;  // [rad] in a cloud: a turn, and what its edges overlap

/// How far the head has turned at each point since the first [rad].
std::vector<double> turned(const std::vector<ScanPoint>& points, bool clockwise) {
  std::vector<double> angles;
  angles.reserve(points.size());
  double first = 0.0, foremost = 0.0;
  for (const ScanPoint& point : points) {
    const double azimuth = (clockwise ? -1.0 : 1.0) * std::atan2(double{point.y}, double{point.x});
    if (angles.empty()) first = azimuth;
    double step = std::remainder(azimuth - first - foremost, kTurn);
    if (step < -kBehind) step += kTurn;
    angles.push_back(foremost + step);
    foremost = std::max(foremost, angles.back());
  }
  return angles;
}

std::string not_in_order(double sum, bool clockwise) {
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the points turn %.1f times %s in one cloud: they are not in the order of firing, their azimuth does not "
      "tell their times",
      sum / kTurn, clockwise ? "clockwise" : "counterclockwise");
  return text;
}

}  // namespace

std::string set_times_by_azimuth(const LidarTurn& turn, Scan& scan) {
  const std::vector<double> angles = turned(scan.points, turn.clockwise);
  if (angles.empty()) return "";
  const auto [least, most] = std::minmax_element(angles.begin(), angles.end());
  if (*most - *least > kMost) return not_in_order(*most - *least, turn.clockwise);
  const double ns_per_radian = 1e9 * turn.duration / kTurn;
  const auto offset = [ns_per_radian](double angle) {
    return static_cast<std::int32_t>(std::lround(angle * ns_per_radian));
  };
  for (std::size_t i = 0; i < angles.size(); ++i) scan.points[i].offset_ns = offset(angles[i]);
  scan.first_offset_ns = offset(*least);
  scan.last_offset_ns = offset(*most);
  return "";
}

}  // namespace allan_lio
