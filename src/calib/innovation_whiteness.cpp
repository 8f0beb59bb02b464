// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/innovation_whiteness.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace allan_lio {

void InnovationWhiteness::add(const PoseInnovation& innovation) {
  if (innovation.dof == 0 || !std::isfinite(innovation.nis)) return;
  nis_.push_back(innovation.nis);
  dof_.push_back(innovation.dof);
}

double InnovationWhiteness::independent_share() const {
  constexpr double kWindow = 5.0;
  const std::size_t count = nis_.size();
  if (count < kFewest) return 1.0;
  const double mean = std::accumulate(nis_.begin(), nis_.end(), 0.0) / std::accumulate(dof_.begin(), dof_.end(), 0.0);
  std::vector<double> excess(count);
  for (std::size_t i = 0; i < count; ++i) excess[i] = nis_[i] - mean * dof_[i];
  const double variance = std::inner_product(excess.begin(), excess.end(), excess.begin(), 0.0);
  if (!(variance > 0.0)) return 1.0;
  double time = 1.0;
  for (std::size_t lag = 1; lag < count / 2 && static_cast<double>(lag) < kWindow * time; ++lag) {
    const auto shift = static_cast<std::ptrdiff_t>(lag);
    time += 2.0 * std::inner_product(excess.begin() + shift, excess.end(), excess.begin(), 0.0) / variance;
  }
  return 1.0 / std::max(1.0, time);
}

}  // namespace allan_lio
