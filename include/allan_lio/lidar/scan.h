// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// One return, in the LiDAR frame at its own time.
struct ScanPoint {
  float x, y, z;           ///< [m]
  float intensity;         ///< as the driver gives it
  std::int32_t offset_ns;  ///< time of the point less Scan::stamp [ns]; may be negative
};

/// What is known of a sweep besides its points.
struct ScanHeader {
  TimeNs stamp = 0;                   ///< the message's stamp; the points' offsets count from here [ns]
  std::int32_t first_offset_ns = 0;   ///< smallest offset among all points that the message holds [ns]
  std::int32_t last_offset_ns = 0;    ///< largest [ns]
  std::uint32_t dropped_invalid = 0;  ///< points that were NaN, inf or exactly zero
  std::uint32_t dropped_range = 0;    ///< points nearer or farther than the limits
  std::uint32_t thinned_away = 0;     ///< points that thin_scan() left out

  TimeNs begin() const { return stamp + first_offset_ns; }
  TimeNs end() const { return stamp + last_offset_ns; }
};

/// One sweep, as decoded: only finite points inside the range limits, in the message's order (which need not
/// be the order of time).
struct Scan : ScanHeader {
  std::vector<ScanPoint> points;

  // Set by thin_scan(), whose points are those for the map.
  bool thinned = false;
  std::vector<std::uint32_t> registered;  ///< indices of the points for the update
};

}  // namespace allan_lio
