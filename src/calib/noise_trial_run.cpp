// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_trial_run.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "allan_lio/calib/horizon_likelihood.h"
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
  Score(const Trajectory& reference, const LioConfig& config)
      : reference_(reference), farthest_(farthest_sane(reference)), horizons_(config) {}

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
    horizons_.add(r);
  }

  bool diverged() const { return result_.diverged; }

  /// `fed`: scans that the odometry was given, `imu` its samples, `accel_scale` what it found them to be in.
  TrialResult finish(const LioCounters& c, std::uint64_t fed, const std::vector<ImuSample>& imu, double accel_scale) {
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
  HorizonLikelihood horizons_;
};

/// The odometry on a record, fed in the order of the messages.
class Run {
 public:
  using OnResult = std::function<void(const LioResult&)>;

  Run(const PreparedRecord& record, const LioConfig& config, const RunPerturbation& perturbation,
      const OnResult& on_result)
      : record_(record),
        leaf_(config.lidar.leaf),
        perturbation_(perturbation),
        on_result_(on_result),
        odometry_(config),
        score_(record.reference(), config) {}

  TrialResult to_its_end() {
    std::uint64_t scans = 0;
    for (std::size_t i = 0; i < record_.scans(); ++i) {
      if (!perturbation_.keeps_scan(i, seconds_between(record_.scan_begin(0), record_.scan_begin(i)))) continue;
      ++scans;
      if (!score_.diverged()) feed(i);
    }
    if (!score_.diverged()) feed_samples(record_.imu().size());
    odometry_.end_of_data();
    take_results();
    return score_.finish(odometry_.counters(), scans, fed_samples_, odometry_.accel_scale());
  }

 private:
  void feed(std::size_t index) {
    feed_samples(record_.samples_before(index));
    Scan scan = record_.scan(index);
    perturbation_.apply(index, leaf_, downsampler_, scan);
    odometry_.add_scan(std::move(scan));
    take_results();
  }

  void feed_samples(std::size_t until) {
    for (; next_sample_ < until; ++next_sample_) {
      if (!perturbation_.keeps_sample(next_sample_)) continue;
      odometry_.add_imu(record_.imu()[next_sample_]);
      fed_samples_.push_back(record_.imu()[next_sample_]);
    }
  }

  void take_results() {
    while (!score_.diverged()) {
      const std::optional<LioResult> result = odometry_.next();
      if (!result) return;
      score_.add(*result);
      if (on_result_) on_result_(*result);
    }
  }

  const PreparedRecord& record_;
  const double leaf_;  ///< [m]
  const RunPerturbation& perturbation_;
  const OnResult& on_result_;
  Odometry odometry_;
  Score score_;
  ScanDownsampler downsampler_;
  std::size_t next_sample_ = 0;
  std::vector<ImuSample> fed_samples_;
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
  LioConfig on_one_thread = with_setting(config, trial.setting);
  on_one_thread.threads = 1;
  const RunPerturbation perturbation(seed, digest, trial.run);
  return Run(record, on_one_thread, perturbation, on_result).to_its_end();
}

}  // namespace allan_lio
