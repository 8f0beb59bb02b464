// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/drift.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kReach = 3.0;  ///< [sigma]

/// Largest 1 sigma of the position along an axis of the world [m].
double position_sigma(const PoseMatrix& covariance) {
  return std::sqrt(std::max(0.0, covariance.diagonal().tail<3>().maxCoeff()));
}

}  // namespace

OldPlanes old_planes(const std::vector<PoseMatrix>& against_parts, const std::vector<std::uint32_t>& last_epochs,
                     double drifted_off) {
  OldPlanes out;
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(against_parts.size(), last_epochs.size()); ++i) {
    const double sigma = position_sigma(against_parts[i]);
    if (sigma < drifted_off) continue;
    out.last_epoch = last_epochs[i];
    largest = std::max(largest, sigma);
  }
  out.reach = kReach * largest;
  return out;
}

const PoseMatrix* farthest_part(const std::vector<PoseMatrix>& against_parts) {
  const auto farthest =
      std::max_element(against_parts.begin(), against_parts.end(),
                       [](const PoseMatrix& a, const PoseMatrix& b) { return position_sigma(a) < position_sigma(b); });
  return farthest == against_parts.end() ? nullptr : &*farthest;
}

}  // namespace allan_lio
