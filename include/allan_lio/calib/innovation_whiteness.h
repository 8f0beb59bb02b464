// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "allan_lio/lio/pose_innovation.h"

namespace allan_lio {

/// How much less a run's innovations say than so many independent ones would. Their likelihood takes them for white; a
/// scale on their covariance is told by nis - dof, so what counts is how that goes on from scan to scan.
class InnovationWhiteness {
 public:
  /// One scan after the other; those without an update are passed over.
  void add(const PoseInnovation& innovation);

  /// Independent innovations over their number: 1/t with the integrated autocorrelation time t = 1 + 2 sum of the
  /// autocorrelations of nis - m dof, m being the mean of nis per degree of freedom. The sum goes up to the first lag
  /// that is five times t (Sokal 1997, section 3). At most 1, and 1 if there are less than kFewest scans.
  double independent_share() const;

  static constexpr std::size_t kFewest = 50;

 private:
  std::vector<double> nis_, dof_;
};

}  // namespace allan_lio
