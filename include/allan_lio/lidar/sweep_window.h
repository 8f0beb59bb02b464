// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// Smallest and largest of many numbers.
struct Extent {
  double smallest = 0.0, largest = 0.0;
};

/// The extent of raw point times without the wild ones: those farther from the middle 98 % than half its width.
/// Sorts `times`, which are finite and at least one.
Extent extent_without_strays(std::vector<double>& times);

/// What to do with a scan in which some points have an absurd time.
struct SweepWindow {
  static constexpr double kStretch = 1.5;       ///< a sweep up to this many times as long as the last one is believed
  static constexpr double kMostStrays = 0.1;    ///< part of the points; with more, the scan says nothing reliable
  static constexpr double kLongestSweep = 1.0;  ///< [s]
};

/// Removes the points outside the window of SweepWindow::kStretch times `usual_ns` [ns] that holds most points, and
/// sets the header's first and last offset to those that stay. Where more than kMostStrays lie outside, the sweep has
/// really become longer: it stays as it is if it lasts at most kLongestSweep. Gives the number of points removed, or
/// nothing for a scan that is to be refused.
std::optional<std::size_t> drop_strays(Scan& scan, double usual_ns);

}  // namespace allan_lio
