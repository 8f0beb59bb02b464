// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_trial_run.h"

#include <optional>
#include <utility>

#include "allan_lio/calib/run_perturbation.h"
#include "allan_lio/lio/odometry.h"
#include "run_score.h"

namespace allan_lio {
namespace {

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

  const std::vector<ImuSample>& fed_samples() const { return fed_samples_; }
  double accel_scale() const { return odometry_.accel_scale(); }

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
  RunScore score_;
  ScanDownsampler downsampler_;
  std::size_t next_sample_ = 0;
  std::vector<ImuSample> fed_samples_;
};

LioConfig single_threaded(const LioConfig& config, const NoiseSetting& setting) {
  LioConfig out = with_setting(config, setting);
  out.threads = 1;
  return out;
}

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

LinearisedTrial run_linearised(const PreparedRecord& record, std::uint64_t digest, const LioConfig& config,
                               const NoiseTrial& trial, std::uint64_t seed) {
  const LioConfig on_one_thread = single_threaded(config, trial.setting);
  const RunPerturbation perturbation(seed, digest, trial.run);
  LinearRunRecorder recorder;
  const std::function<void(const LioResult&)> record_it = [&](const LioResult& result) { recorder.add(result); };
  Run run(record, on_one_thread, perturbation, record_it);
  LinearisedTrial out;
  out.trial = trial;
  out.result = run.to_its_end();
  if (!out.result.diverged) out.run = recorder.finish(on_one_thread, run.fed_samples(), run.accel_scale());
  return out;
}

TrialResult run_trial(const PreparedRecord& record, std::uint64_t digest, const LioConfig& config,
                      const NoiseTrial& trial, std::uint64_t seed,
                      const std::function<void(const LioResult&)>& on_result) {
  const LioConfig on_one_thread = single_threaded(config, trial.setting);
  const RunPerturbation perturbation(seed, digest, trial.run);
  return Run(record, on_one_thread, perturbation, on_result).to_its_end();
}

}  // namespace allan_lio
