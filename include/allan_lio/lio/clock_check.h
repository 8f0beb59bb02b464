// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// Tells by the stamps whether LiDAR and IMU go by different clocks: both have spoken for some seconds, no scan could
/// be used, and the two ranges of time lie apart.
class ClockCheck {
 public:
  static constexpr double kEnough = 3.0;       ///< [s] of data from each
  static constexpr double kApart = 1.0;        ///< [s] between the ranges; less may be a matter of transport
  static constexpr std::uint64_t kScans = 10;  ///< and so many scans

  void add_imu(TimeNs stamp) { imu_.add(stamp); }
  void add_scan(TimeNs stamp) { lidar_.add(stamp); }
  /// A scan has been used, or the data begins anew: what came so far proves nothing.
  void begin_again() { *this = ClockCheck(); }

  /// A sentence with both ranges if the clocks lie apart, else empty.
  std::string trouble() const;

 private:
  struct Range {
    TimeNs begin = 0, end = 0;
    std::uint64_t count = 0;
    void add(TimeNs stamp);
    double seconds() const { return seconds_between(begin, end); }
  };
  Range imu_, lidar_;
};

}  // namespace allan_lio
