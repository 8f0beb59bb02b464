// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lidar/point_time.h"
#include "allan_lio/lidar/scan.h"
#include "allan_lio/ros/cloud_layout.h"

namespace allan_lio {

struct PointLimits {
  float smallest_squared, largest_squared;  ///< of the range [m^2]
  bool drop_tagged;
};

/// Points that were dropped for one reason alone.
struct DroppedPoints {
  std::size_t time = 0, tag = 0;
};

/// What the points with a valid position say about their times. The layout has a time.
PointTimeEvidence gather_evidence(const CloudLayout& layout, TimeNs stamp);

/// Fills the scan's points, counts and first and last offset in one pass. The layout has a time.
DroppedPoints read_timed(const CloudLayout& layout, const PointLimits& limits, const PointTimeScale& scale, Scan& scan);

/// The same without times: every point is at the stamp.
DroppedPoints read_untimed(const CloudLayout& layout, const PointLimits& limits, Scan& scan);

/// A raw time from the sweep's midst, which no stray point decides; 0 if there is none.
double middle_raw_time(const CloudLayout& layout);

}  // namespace allan_lio
