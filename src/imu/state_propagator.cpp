// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/state_propagator.h"

#include <vector>

namespace allan_lio {
namespace {

/// Samples that are kept while no correction comes [ns].
constexpr TimeNs kMemory = 60 * kNsPerSecond;

}  // namespace

ImuSample StatePropagator::scaled(const ImuSample& sample) const {
  return {sample.stamp, sample.gyro, accel_scale_ * sample.accel};
}

void StatePropagator::step(const ImuSample& from, const ImuSample& to) {
  const ImuInterval interval = mean_interval(estimate_.state, from, to);
  const double spacing = samples_.spacing_at(from.stamp + (to.stamp - from.stamp) / 2);
  const ImuNoise noise = noise_between(noise_, options_.range, from, to, spacing);
  const DiscreteModel model = discretize(estimate_.state, interval, noise, options_.discretization);
  const NavMatrix covariance = model.phi * estimate_.covariance * model.phi.transpose() + model.q;
  estimate_.covariance = 0.5 * (covariance + covariance.transpose());
  estimate_.state = propagate_mean(estimate_.state, interval, noise_);
  estimate_.state.stamp = to.stamp;
  estimate_.gyro = to.gyro - estimate_.state.gyro_bias;
  last_ = to;
}

void StatePropagator::restart(const NavState& state, const NavMatrix& covariance, const ImuNoise& noise,
                              double accel_scale) {
  estimate_.state = state;
  estimate_.covariance = covariance;
  noise_ = noise;
  accel_scale_ = accel_scale;
  if (gate_.accel_scale() != accel_scale) {  // what is at hand was let through in another unit
    gate_.set_accel_scale(accel_scale);
    samples_.remove_if([accel_scale](const ImuSample& sample) { return !is_sane(sample, accel_scale); });
  }
  started_ = !samples_.empty();
  if (!started_) return;
  last_ = scaled(samples_.at(state.stamp));
  last_.stamp = state.stamp;
  estimate_.gyro = last_.gyro - state.gyro_bias;
  if (samples_.newest() > state.stamp) {
    const std::vector<ImuSample> since = samples_.between(state.stamp, samples_.newest());
    for (std::size_t i = 1; i < since.size(); ++i) step(scaled(since[i - 1]), scaled(since[i]));
  }
  samples_.discard_before(state.stamp);
}

bool StatePropagator::add(const ImuSample& sample) {
  const ImuGate::Passed passed = gate_.pass(sample);
  const bool gap_was_real = passed.kept_back && take(*passed.kept_back);
  return passed.sample ? take(*passed.sample) : gap_was_real;
}

bool StatePropagator::take(const ImuSample& sample) {
  const TimeNs before = samples_.empty() ? sample.stamp : samples_.newest();
  if (!samples_.push(sample)) return false;
  sample_interval_ = seconds_between(before, sample.stamp);
  samples_.discard_before(sample.stamp - kMemory);
  if (sample_interval_ > options_.max_gap) started_ = false;
  if (!started_ || sample.stamp <= last_.stamp) return false;
  step(last_, scaled(sample));
  return true;
}

void StatePropagator::clear() {
  samples_.clear();
  gate_ = ImuGate();
  started_ = false;
}

}  // namespace allan_lio
