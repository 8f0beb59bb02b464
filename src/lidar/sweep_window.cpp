// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/sweep_window.h"

#include <algorithm>
#include <cstdint>

namespace allan_lio {
namespace {

struct Window {
  std::int64_t first = 0, last = 0;  ///< [ns]
  std::size_t points = 0;
};

/// The window of this width that holds most of the sorted offsets; the earliest of equals.
Window fullest_window(const std::vector<std::int32_t>& offsets, std::int64_t width) {
  Window best;
  std::size_t begin = 0;
  for (std::size_t end = 0; end < offsets.size(); ++end) {
    while (std::int64_t{offsets[end]} - offsets[begin] > width) ++begin;
    if (end + 1 - begin > best.points) best = {offsets[begin], offsets[end], end + 1 - begin};
  }
  return best;
}

}  // namespace

Extent extent_without_strays(std::vector<double>& times) {
  constexpr double kTail = 0.01;
  std::sort(times.begin(), times.end());
  const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(times.size()));
  const double low = times[tail], high = times[times.size() - 1 - tail];
  const double margin = 0.5 * (high - low);
  const auto first = std::lower_bound(times.begin(), times.end(), low - margin);
  const auto behind = std::upper_bound(times.begin(), times.end(), high + margin);
  return {*first, *(behind - 1)};
}

std::optional<std::size_t> drop_strays(Scan& scan, double usual_ns) {
  std::vector<std::int32_t> offsets;
  offsets.reserve(scan.points.size());
  for (const ScanPoint& point : scan.points) offsets.push_back(point.offset_ns);
  std::sort(offsets.begin(), offsets.end());
  if (offsets.empty()) {
    scan.first_offset_ns = scan.last_offset_ns = 0;
    return 0;
  }
  Window window = fullest_window(offsets, static_cast<std::int64_t>(SweepWindow::kStretch * usual_ns));
  const std::size_t strays = offsets.size() - window.points;
  if (static_cast<double>(strays) > SweepWindow::kMostStrays * static_cast<double>(offsets.size())) {
    const std::int64_t length = std::int64_t{offsets.back()} - offsets.front();
    if (length > static_cast<std::int64_t>(1e9 * SweepWindow::kLongestSweep)) return std::nullopt;
    window = {offsets.front(), offsets.back(), offsets.size()};
  }
  const auto stray = [&](const ScanPoint& p) { return p.offset_ns < window.first || p.offset_ns > window.last; };
  scan.points.erase(std::remove_if(scan.points.begin(), scan.points.end(), stray), scan.points.end());
  scan.first_offset_ns = static_cast<std::int32_t>(window.first);
  scan.last_offset_ns = static_cast<std::int32_t>(window.last);
  return offsets.size() - window.points;
}

}  // namespace allan_lio
