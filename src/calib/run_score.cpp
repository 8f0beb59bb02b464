// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "allan_lio/eval/trajectory_error.h"

namespace allan_lio {
namespace {

constexpr double kLog2Pi = 1.83787706640934548356;
constexpr double kPathsAway = 100.0;

double farthest_sane(const Trajectory& reference) {
  if (reference.empty()) return kFarthestDivergence;
  double path = 0.0;
  for (std::size_t i = 1; i < reference.size(); ++i)
    path += (reference[i].pose.translation - reference[i - 1].pose.translation).norm();
  return std::min(std::max(kPathsAway * path, kNearestDivergence), kFarthestDivergence);
}

double scan_nll(const LioResult& r) {
  if (r.outcome == ScanOutcome::kTooFewMatches) return kUnmatchedNll;
  const PoseInnovation& z = r.innovation;
  return 0.5 * (z.nis + z.log_det + z.dof * kLog2Pi);
}

}  // namespace

RunScore::RunScore(const Trajectory& reference, const LioConfig& config)
    : reference_(reference), farthest_(farthest_sane(reference)), horizons_(config) {}

void RunScore::add(const LioResult& r) {
  const Eigen::Vector3d& position = r.state.nav.T_world_imu.translation;
  const double nll = scan_nll(r);
  ++result_.scans;
  if (!(position.norm() <= farthest_) || !r.state.nav.T_world_imu.rotation.coeffs().allFinite() ||
      !std::isfinite(nll) || r.outcome == ScanOutcome::kMapRestarted) {
    result_.diverged = true;
    return;
  }
  result_.nll += std::min(nll, kWorstScanNll);
  result_.nis += r.innovation.nis;
  result_.nis_dof += static_cast<std::uint64_t>(r.innovation.dof);
  estimate_.push_back({r.state.nav.stamp, r.state.nav.T_world_imu});
  horizons_.add(r);
}

TrialResult RunScore::finish(const LioCounters& c, std::uint64_t fed, const std::vector<ImuSample>& imu,
                             double accel_scale) {
  const std::uint64_t of_no_use =
      c.scans_before_imu + c.scans_after_imu + c.scans_dropped_order + c.scans_overflow + c.scans_too_few_points;
  if (c.scans_used == 0 || 2 * c.scans_used < c.scans_read - of_no_use) result_.diverged = true;
  if (!result_.diverged && !reference_.empty()) measure();
  if (!result_.diverged) {
    const HorizonScore over_horizons = horizons_.score(imu, accel_scale);
    result_.horizon_nll = over_horizons.nll;
    result_.horizon_nis = over_horizons.nis;
    result_.horizon_dof = over_horizons.dof;
    result_.horizon_share = over_horizons.independent_share;
    return result_;
  }
  result_.nll = result_.horizon_nll = kWorstScanNll * static_cast<double>(2 * fed - result_.scans + 1);
  if (!reference_.empty()) result_.ate = result_.end_error = std::numeric_limits<double>::infinity();
  return result_;
}

void RunScore::measure() {
  try {
    const TrajectoryError error = evaluate_trajectory(reference_, estimate_, Alignment::kSe3);
    result_.ate = error.translation.rmse;
    result_.end_error = error.end_drift;
  } catch (const std::runtime_error&) {
    result_.diverged = true;  // the truth can be aligned to, so it is the estimate that never left its place
  }
}

}  // namespace allan_lio
