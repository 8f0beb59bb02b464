// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_run.h"

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/interval_noise.h"
#include "allan_lio/imu/propagate.h"
#include "allan_lio/lio/bias_mean.h"
#include "horizon_misfit.h"

namespace allan_lio {
namespace {

/// Nothing but the bias rates.
ImuNoise without_noise(ImuNoise noise) {
  noise.gyro_psd.setZero();
  noise.accel_psd.setZero();
  noise.gyro_bias_psd.setZero();
  noise.accel_bias_psd.setZero();
  return noise;
}

/// The noise with k = 1, alone and by its four parts.
struct NoiseParts {
  ImuNoise whole;
  std::array<ImuNoise, 4> parts;

  explicit NoiseParts(const LioConfig& config)
      : whole(make_imu_noise(config.imu.spec, NoiseScale(), config.imu.bias_model)) {
    parts.fill(without_noise(whole));
    parts[0].gyro_psd = whole.gyro_psd;
    parts[1].accel_psd = whole.accel_psd;
    parts[2].gyro_bias_psd = whole.gyro_bias_psd;
    parts[3].accel_bias_psd = whole.accel_bias_psd;
  }
};

/// What was added for a gap or a saturated reading.
ImuNoise bridge_of(const ImuNoise& inflated, const ImuNoise& noise) {
  ImuNoise bridge = without_noise(noise);
  bridge.gyro_psd = inflated.gyro_psd - noise.gyro_psd;
  bridge.accel_psd = inflated.accel_psd - noise.accel_psd;
  return bridge;
}

/// phi, noise, bridged and correction from one state to the next.
void link(const ImuBuffer& imu, const NavState& from, const NavState& to, const LioConfig& config,
          const NoiseParts& noise, LinearScan& scan) {
  const Discretization method =
      config.imu.discretization == Discretization::kVanLoan ? Discretization::kTrapezoid : config.imu.discretization;
  const ImuRange range{config.imu.gyro_range, config.imu.accel_range};
  const std::vector<ImuSample> samples = imu.between(from.stamp, to.stamp);
  NavState nav = from;
  const auto add = [](const DiscreteModel& model, NavMatrix& sum) {
    sum = (model.phi * sum * model.phi.transpose() + model.q).eval();
  };
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ImuInterval interval = mean_interval(nav, samples[i - 1], samples[i]);
    if (!(interval.dt > 0.0)) continue;
    DiscreteModel model;
    for (std::size_t part = 0; part < scan.noise.size(); ++part) {
      model = discretize(nav, interval, noise.parts[part], method);
      add(model, scan.noise[part]);
    }
    const ImuNoise bridge =
        bridge_of(noise_between(noise.whole, range, samples[i - 1], samples[i], interval.dt), noise.whole);
    add(discretize(nav, interval, bridge, method), scan.bridged);
    scan.phi = (model.phi * scan.phi).eval();
    nav = propagate_mean(nav, interval, noise.whole);
  }
  scan.step = seconds_between(from.stamp, to.stamp);
  scan.correction = inertial_minus(to, nav);
}

/// What the registration measured, about the state that came of it.
void measure(const LioResult& result, LinearScan& scan) {
  const ScanMeasurement& m = result.measurement;
  const SupportedAxes axes = supported_axes(result.localizability);
  const PoseMatrix from_y = unscaled_directions(result.localizability);
  PoseMatrix to_imu = PoseMatrix::Identity();
  to_imu.topLeftCorner<3, 3>() = result.state.nav.T_world_imu.rotation.toRotationMatrix().transpose();
  const PoseVector moved = nav_minus(m.at, result.state.nav).head<6>();
  scan.rows = axes.rows;
  scan.map_rows = axes.rows * to_imu;
  scan.measured.resize(axes.count);
  scan.variances.resize(axes.count);
  for (int i = 0; i < axes.count; ++i) {
    const PoseVector x = from_y.col(axes.directions[i]);
    const double information = x.dot(m.information * x);
    scan.measured[i] = x.dot(m.gradient) / information + axes.rows.row(i).dot(moved);
    scan.variances[i] = 1.0 / (information * result.localizability.support[axes.directions[i]]);
  }
  scan.log_gram = axes.log_gram;
  scan.view_noise = m.view_noise;
  scan.view_kept = m.view_kept;
  scan.deskewed = m.deskewed;
}

}  // namespace

void LinearRunRecorder::add(const LioResult& result) {
  if (result.standing) results_.clear();  // what that told is in its covariance
  results_.push_back(result);
}

LinearRun LinearRunRecorder::finish(const LioConfig& config, const std::vector<ImuSample>& imu,
                                    double accel_scale) const {
  LinearRun run;
  if (results_.empty() || imu.empty()) return run;
  ImuBuffer buffer;
  for (ImuSample sample : imu) {
    sample.accel *= accel_scale;
    buffer.push(sample);
  }
  const NoiseParts noise(config);
  run.gyro_psd = noise.whole.gyro_psd;
  run.k_r = config.lidar.k_r;
  run.initial_covariance = results_[0].covariance.topLeftCorner<kInertialDof, kInertialDof>();
  run.scans.resize(results_.size());
  for (std::size_t i = 0; i < results_.size(); ++i) {
    LinearScan& scan = run.scans[i];
    const NavState& nav = results_[i].state.nav;
    scan.noise.fill(NavMatrix::Zero());
    scan.time = seconds_between(results_[0].state.nav.stamp, nav.stamp);
    if (i > 0 && nav.stamp > results_[i - 1].state.nav.stamp)
      link(buffer, results_[i - 1].state.nav, nav, config, noise, scan);
    scan.bridged.topLeftCorner<6, 6>() += results_[i].relocated * results_[i].relocated.transpose();
    if (results_[i].outcome == ScanOutcome::kUpdated) measure(results_[i], scan);
  }
  return run;
}

}  // namespace allan_lio
