// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/noise_record.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "allan_lio/imu/markov_step.h"

namespace allan_lio {
namespace {

constexpr double kLog2 = 0.69314718055994530942, kPi = 3.14159265358979323846;

// Streams of the terms; the processes of flicker noise count on from the last.
enum Stream : std::uint64_t { kWhite, kQuantization, kMarkov, kWalk, kFlicker };

void require_term(const char* name, double value) {
  if (!(value >= 0 && std::isfinite(value)))
    throw std::invalid_argument(std::string("NoiseRecord: ") + name + " must be finite and not negative");
}

void require_positive(const char* name, double value) {
  if (!(value > 0 && std::isfinite(value)))
    throw std::invalid_argument(std::string("NoiseRecord: ") + name + " must be finite and positive");
}

}  // namespace

std::vector<FlickerProcess> flicker_processes(double instability, double rate, double duration) {
  constexpr double kStep = 4.0;          // ratio of neighbouring correlation times
  constexpr double kBeyond = 16.0;       // the slowest one, in lengths of the record
  constexpr double kDrawsPerTime = 8.0;  // draws a correlation time
  // A sum even in log T has the Allan variance 2 sigma^2/ln(step) * integral of F(lambda)/lambda = ln 2.
  const double sigma = instability * std::sqrt((2.0 * kLog2 / kPi) * std::log(kStep) / (2.0 * kLog2));
  std::vector<FlickerProcess> processes;
  // Over many samples a process much faster than a sample is white noise of density 2 sigma^2 T: the sum of them all,
  // T = 1/4, 1/16, ... samples.
  processes.push_back({sigma * std::sqrt(2.0 / (kStep - 1.0)), 0.0, 1});
  for (double samples = 1.0; samples < kBeyond * kStep * duration * rate; samples *= kStep) {
    FlickerProcess process;
    process.time = samples / rate;
    process.hold = std::max<std::int64_t>(1, static_cast<std::int64_t>(samples / kDrawsPerTime));
    // Holding raises the density at zero frequency by x coth x.
    const double x = 0.5 * static_cast<double>(process.hold) / samples;
    process.sigma = sigma * std::sqrt(std::tanh(x) / x);
    processes.push_back(process);
  }
  return processes;
}

NoiseRecord::NoiseRecord(const NoiseTerms& terms, double rate, double duration, std::uint64_t seed)
    : white_(terms.white * std::sqrt(rate)),
      quantization_(terms.quantization * rate),
      white_normals_(seed, kWhite),
      quantization_normals_(seed, kQuantization),
      markov_{0, 0, 0, 0, 0, 0, NormalStream(seed, kMarkov)},
      walk_{0, 1, 1, 0, 0, 0, NormalStream(seed, kWalk)},
      has_markov_(terms.markov_sigma > 0),
      has_walk_(terms.random_walk > 0) {
  require_positive("the rate", rate);
  require_positive("the duration", duration);
  require_positive("the correlation time", terms.markov_time);
  require_term("quantisation", terms.quantization);
  require_term("white noise", terms.white);
  require_term("bias instability", terms.instability);
  require_term("the random walk", terms.random_walk);
  require_term("the Gauss-Markov bias", terms.markov_sigma);

  rounding_ = quantization_ * quantization_normals_.next();

  const double sigma = terms.markov_sigma;
  const MarkovStep step = markov_step(1.0 / (rate * terms.markov_time));
  markov_.decay = step.decay;
  markov_.mean_gain = step.mean_gain;
  markov_.value = sigma * markov_.normals.next();
  markov_.value_noise = sigma * std::sqrt(step.value_variance);
  markov_.mean_by_value = sigma * step.covariance / std::sqrt(step.value_variance);
  markov_.mean_own =
      sigma * std::sqrt(std::max(0.0, step.mean_variance - step.covariance * step.covariance / step.value_variance));

  walk_.value_noise = terms.random_walk / std::sqrt(rate);
  walk_.mean_by_value = 0.5 * walk_.value_noise;
  walk_.mean_own = walk_.value_noise / std::sqrt(12.0);

  if (!(terms.instability > 0)) return;
  for (const FlickerProcess& process : flicker_processes(terms.instability, rate, duration)) {
    NormalStream normals(seed, kFlicker + flicker_.size());
    const double a_hold = static_cast<double>(process.hold) / (rate * process.time);  // infinite for white noise
    const double start = process.sigma * normals.next();
    flicker_.push_back({normals, std::exp(-a_hold), process.sigma * std::sqrt(-std::expm1(-2.0 * a_hold)), process.hold,
                        process.hold, start});
  }
}

double NoiseRecord::Bias::next() {
  const double first = normals.next(), second = normals.next();
  const double mean = mean_gain * value + mean_by_value * first + mean_own * second;
  value = decay * value + value_noise * first;
  return mean;
}

double NoiseRecord::next_flicker() {
  double sum = 0.0;
  for (Flicker& process : flicker_) {
    if (process.left == 0) {
      process.value = process.decay * process.value + process.drive * process.normals.next();
      process.left = process.hold;
    }
    --process.left;
    sum += process.value;
  }
  return sum;
}

double NoiseRecord::next() {
  double rate = next_flicker();
  if (white_ > 0) rate += white_ * white_normals_.next();
  if (quantization_ > 0) {
    const double last = rounding_;
    rounding_ = quantization_ * quantization_normals_.next();
    rate += rounding_ - last;
  }
  if (has_markov_) rate += markov_.next();
  if (has_walk_) rate += walk_.next();
  return rate;
}

}  // namespace allan_lio
