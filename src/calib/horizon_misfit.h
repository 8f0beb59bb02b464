// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "allan_lio/calib/horizon_likelihood.h"
#include "allan_lio/calib/linear_run.h"

namespace allan_lio {

/// The directions that a scan supports, as coordinates in metres at the scene's scale.
struct SupportedAxes {
  int count = 0;
  int directions[6] = {};  ///< columns of Localizability::directions, ascending
  SupportedRows rows;      ///< from the pose's error to the coordinates [m/rad, 1]
  double log_gram = 0.0;   ///< the axes need not be orthogonal: what a log determinant in metres has more
};
SupportedAxes supported_axes(const Localizability& localizability);

/// A prediction held against an estimate.
struct HorizonMisfit {
  double nll = 0.0, nis = 0.0;
  int dof = 0;
};

/// `error` of the estimate against the prediction of `seconds` ago, in the coordinates of SupportedAxes; `predicted`
/// and `known` are the covariances of prediction and estimate, whose difference is at least `least_gain` of the former.
HorizonMisfit horizon_misfit(const SupportedVector& error, const SupportedMatrix& predicted,
                             const SupportedMatrix& known, double log_gram, double seconds, double least_gain);

/// Sums of a run and of its stretches.
class HorizonSums {
 public:
  static constexpr double kBeginsPerHorizon = 4.0;

  /// `end`: of the horizon, since the run's first state [s].
  void add(const HorizonMisfit& misfit, double end);
  HorizonScore finish() const;

 private:
  HorizonScore score_;
  std::vector<double> nis_, dof_;  ///< by stretch
};

/// Calls visit(begin, end, seconds) for every horizon of a run: indices of the two scans. `times` of the scans [s],
/// ascending from 0; `updated`: whether a scan can be a begin or an end.
template <class Visit>
void for_each_horizon(const std::vector<double>& times, const std::vector<bool>& updated, const Visit& visit) {
  for (const double horizon : kHorizons) {
    double next_begin = 0.0;
    std::size_t end = 0;
    for (std::size_t begin = 0; begin + 1 < times.size(); ++begin) {
      if (!updated[begin] || times[begin] < next_begin) continue;
      while (next_begin <= times[begin]) next_begin += horizon / HorizonSums::kBeginsPerHorizon;
      while (end + 1 < times.size() && times[end] - times[begin] < horizon) ++end;
      const double seconds = times[end] - times[begin];
      if (seconds < horizon) break;
      if (updated[end]) visit(begin, end, seconds);
    }
  }
}

}  // namespace allan_lio
