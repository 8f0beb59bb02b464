// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/horizon_likelihood.h"

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/interval_noise.h"
#include "allan_lio/imu/propagate.h"
#include "allan_lio/lio/bias_mean.h"
#include "horizon_misfit.h"

namespace allan_lio {
namespace {

/// What lies between two scans' states.
struct Step {
  std::vector<ImuSample> samples;
  NavMatrix phi = NavMatrix::Identity();
  NavMatrix q = NavMatrix::Zero();
};

Step make_step(const ImuBuffer& imu, const NavState& from, TimeNs to, const LioConfig& config, const ImuNoise& noise) {
  Step step;
  if (to <= from.stamp) return step;
  step.samples = imu.between(from.stamp, to);
  const ImuRange range{config.imu.gyro_range, config.imu.accel_range};
  NavState nav = from;
  for (std::size_t i = 1; i < step.samples.size(); ++i) {
    const ImuSample &begin = step.samples[i - 1], &end = step.samples[i];
    const ImuInterval interval = mean_interval(nav, begin, end);
    const DiscreteModel model =
        discretize(nav, interval, noise_between(noise, range, begin, end, interval.dt), config.imu.discretization);
    step.phi = model.phi * step.phi;
    step.q = model.phi * step.q * model.phi.transpose() + model.q;
    nav = propagate_mean(nav, interval, noise);
  }
  return step;
}

struct Prediction {
  NavState nav;
  InertialMatrix covariance;
};

void advance(const Step& step, const ImuNoise& noise, Prediction& prediction) {
  for (std::size_t i = 1; i < step.samples.size(); ++i)
    prediction.nav =
        propagate_mean(prediction.nav, mean_interval(prediction.nav, step.samples[i - 1], step.samples[i]), noise);
  carry(step.phi, prediction.covariance);
  prediction.covariance.topLeftCorner<kNavDof, kNavDof>() += step.q;
}

}  // namespace

void HorizonLikelihood::add(const LioResult& result) {
  if (result.standing) entries_.clear();  // nothing was reckoned there
  entries_.push_back({result.state.nav, result.covariance.topLeftCorner<kInertialDof, kInertialDof>(),
                      result.localizability, result.relocated, result.outcome == ScanOutcome::kUpdated});
}

HorizonScore HorizonLikelihood::score(const std::vector<ImuSample>& imu, double accel_scale) const {
  ImuBuffer buffer;
  for (ImuSample sample : imu) {
    sample.accel *= accel_scale;
    buffer.push(sample);
  }
  if (buffer.empty() || entries_.size() < 2) return {};
  const ImuNoise noise = make_imu_noise(config_.imu.spec, config_.imu.scale, config_.imu.bias_model);
  std::vector<Step> steps(entries_.size());  // each leads to the entry of its index
  for (std::size_t i = 1; i < entries_.size(); ++i)
    steps[i] = make_step(buffer, entries_[i - 1].nav, entries_[i].nav.stamp, config_, noise);
  // Where the run was set right it had been wrong by more than reckoning told, whatever the noise.
  for (std::size_t i = 1; i < entries_.size(); ++i)
    steps[i].q.topLeftCorner<6, 6>() += entries_[i].relocated * entries_[i].relocated.transpose();

  std::vector<double> times;
  std::vector<bool> updated;
  for (const Entry& entry : entries_) {
    times.push_back(seconds_between(entries_[0].nav.stamp, entry.nav.stamp));
    updated.push_back(entry.updated);
  }
  HorizonSums sums;
  for_each_horizon(times, updated, [&](std::size_t begin, std::size_t end, double seconds) {
    Prediction prediction{entries_[begin].nav, entries_[begin].covariance};
    for (std::size_t i = begin + 1; i <= end; ++i) advance(steps[i], noise, prediction);
    const Entry& last = entries_[end];
    const SupportedAxes axes = supported_axes(last.localizability);
    const auto along = [&axes](const InertialMatrix& covariance) {
      return SupportedMatrix(axes.rows * covariance.topLeftCorner<6, 6>() * axes.rows.transpose());
    };
    sums.add(horizon_misfit(axes.rows * nav_minus(last.nav, prediction.nav).head<6>(), along(prediction.covariance),
                            along(last.covariance), axes.log_gram, seconds, HorizonLikelihood::kLeastGain),
             times[end]);
  });
  return sums.finish();
}

}  // namespace allan_lio
