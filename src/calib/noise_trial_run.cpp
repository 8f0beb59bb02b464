// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_trial_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "allan_lio/calib/run_perturbation.h"
#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/lio/odometry.h"

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

/// A run as its states come in.
class Score {
 public:
  explicit Score(const Trajectory& reference) : reference_(reference), farthest_(farthest_sane(reference)) {}

  void add(const LioResult& r) {
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
  }

  bool diverged() const { return result_.diverged; }

  /// `fed`: scans that the odometry was given.
  TrialResult finish(const LioCounters& c, std::uint64_t fed) {
    const std::uint64_t of_no_use =
        c.scans_before_imu + c.scans_after_imu + c.scans_dropped_order + c.scans_overflow + c.scans_too_few_points;
    if (c.scans_used == 0 || 2 * c.scans_used < c.scans_read - of_no_use) result_.diverged = true;
    if (!result_.diverged && !reference_.empty()) measure();
    if (!result_.diverged) return result_;
    result_.nll = kWorstScanNll * static_cast<double>(2 * fed - result_.scans + 1);
    if (!reference_.empty()) result_.ate = result_.end_error = std::numeric_limits<double>::infinity();
    return result_;
  }

 private:
  void measure() {
    try {
      const TrajectoryError error = evaluate_trajectory(reference_, estimate_, Alignment::kSe3);
      result_.ate = error.translation.rmse;
      result_.end_error = error.end_drift;
    } catch (const std::runtime_error&) {
      result_.diverged = true;  // the truth can be aligned to, so it is the estimate that never left its place
    }
  }

  const Trajectory& reference_;
  const double farthest_;  ///< [m]
  TrialResult result_;
  Trajectory estimate_;
};

}  // namespace

LioConfig with_setting(LioConfig config, const NoiseSetting& setting) {
  config.imu.scale = setting.imu;
  config.lidar.k_r = setting.k_r;
  return config;
}

TrialResult run_trial(const PreparedRecord& record, const LioConfig& config, const NoiseTrial& trial,
                      std::uint64_t seed, const std::function<void(const LioResult&)>& on_result) {
  return run_trial(record, record.digest(), config, trial, seed, on_result);
}

TrialResult run_trial(const PreparedRecord& record, std::uint64_t digest, const LioConfig& config,
                      const NoiseTrial& trial, std::uint64_t seed,
                      const std::function<void(const LioResult&)>& on_result) {
  LioConfig trial_config = with_setting(config, trial.setting);
  trial_config.threads = 1;
  const RunPerturbation perturbation(seed, digest, trial.run);
  Odometry odometry(trial_config);
  ScanDownsampler downsampler;
  Score score(record.reference());
  std::uint64_t fed = 0;
  std::size_t sample = 0;
  const auto feed_samples = [&](std::size_t until) {
    for (; sample < until; ++sample)
      if (perturbation.keeps_sample(sample)) odometry.add_imu(record.imu()[sample]);
  };
  const auto take_results = [&] {
    while (!score.diverged()) {
      const std::optional<LioResult> result = odometry.next();
      if (!result) return;
      score.add(*result);
      if (on_result) on_result(*result);
    }
  };
  for (std::size_t i = 0; i < record.scans(); ++i) {
    if (!perturbation.keeps_scan(i, seconds_between(record.scan_begin(0), record.scan_begin(i)))) continue;
    ++fed;
    if (score.diverged()) continue;
    feed_samples(record.samples_before(i));
    Scan scan = record.scan(i);
    perturbation.apply(i, config.lidar.leaf, downsampler, scan);
    odometry.add_scan(std::move(scan));
    take_results();
  }
  feed_samples(record.imu().size());
  odometry.end_of_data();
  take_results();
  return score.finish(odometry.counters(), fed);
}

}  // namespace allan_lio
