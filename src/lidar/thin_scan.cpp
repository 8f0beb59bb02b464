// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/thin_scan.h"

#include <algorithm>

namespace allan_lio {

Scan thin_scan(const Scan& scan, double insert_leaf, double leaf, ScanDownsampler& downsampler) {
  std::vector<std::uint32_t> inserted;
  downsampler.select(scan.points, nullptr, insert_leaf, inserted);
  Scan thinned;
  static_cast<ScanHeader&>(thinned) = scan;
  thinned.thinned = true;
  thinned.thinned_away += static_cast<std::uint32_t>(scan.points.size() - inserted.size());
  thinned.points.reserve(inserted.size());
  for (const std::uint32_t index : inserted) thinned.points.push_back(scan.points[index]);
  downsampler.select(thinned.points, nullptr, leaf, thinned.registered);
  return thinned;
}

std::vector<std::uint32_t> registered_at_phase(const std::vector<ScanPoint>& points, double leaf, std::uint32_t phase,
                                               ScanDownsampler& downsampler) {
  const std::uint32_t count = static_cast<std::uint32_t>(points.size());
  std::vector<std::uint32_t> order, kept;
  order.reserve(points.size());
  for (std::uint32_t k = 0; k < kThinningPhases; ++k)
    for (std::uint32_t i = (phase + k) % kThinningPhases; i < count; i += kThinningPhases) order.push_back(i);
  downsampler.select(points, &order, leaf, kept);
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace allan_lio
