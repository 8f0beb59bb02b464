// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/drift.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kDriftedOff = 0.1;  ///< 1 sigma [m]
constexpr double kReach = 3.0;       ///< [sigma]

}  // namespace

OldPlanes old_planes(const std::vector<PoseMatrix>& against_parts, const std::vector<std::uint32_t>& last_epochs) {
  OldPlanes out;
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(against_parts.size(), last_epochs.size()); ++i) {
    const double sigma = std::sqrt(against_parts[i].diagonal().tail<3>().maxCoeff());
    if (sigma < kDriftedOff) continue;
    out.last_epoch = last_epochs[i];
    largest = std::max(largest, sigma);
  }
  out.reach = kReach * largest;
  return out;
}

}  // namespace allan_lio
