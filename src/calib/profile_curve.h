// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <vector>

#include "allan_lio/calib/noise_evaluator.h"
#include "allan_lio/calib/noise_profile.h"

namespace allan_lio {

/// The profile of one coefficient while it is sampled: by the distance t from the optimum's ln k.
class ProfileCurve {
 public:
  /// The optimum lies at t = 0; `low` and `high` are the ends of the reach.
  ProfileCurve(std::size_t optimum, double low, double high) : low_(low), high_(high) { places_[0.0] = optimum; }

  void add(double t, std::size_t place) { places_[t] = place; }
  /// A point was taken there, or so near that another tells nothing new.
  bool has(double t) const;
  const std::map<double, std::size_t>& places() const { return places_; }
  double low() const { return low_; }
  double high() const { return high_; }

  /// Where the data's part of the objective is `level` above its lowest, farthest out, side -1 or 1: interpolated on
  /// the root of the rise, which is straight for a parabola. Infinite (with the side's sign) if the last point is not
  /// that high.
  double crossing(const NoiseEvaluator& evaluator, int side, double level) const;

  /// The data's part of the objective above its lowest on the curve.
  std::map<double, double> rises(const NoiseEvaluator& evaluator) const;

 private:
  double low_, high_;
  std::map<double, std::size_t> places_;
};

/// Where the point of coefficient i at distance t lies: ln k of all.
using ProfilePath = std::function<Eigen::VectorXd(Eigen::Index i, double t)>;

/// The second derivatives of the objective over ln k by differences of the given widths, one batch of n (n + 1)
/// settings; eigenvalues below `least` are raised to it.
Eigen::MatrixXd curvature_at(NoiseEvaluator& evaluator, std::size_t optimum, const Eigen::VectorXd& widths,
                             double least);

}  // namespace allan_lio
