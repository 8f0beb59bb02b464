// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/calib/allan_fit.h"
#include "allan_lio/sim/random.h"

namespace allan_lio {

/// One of the Gauss-Markov processes whose sum is flicker noise: drawn every `hold` samples and held between.
struct FlickerProcess {
  double sigma = 0.0;     ///< steady-state deviation [u]
  double time = 0.0;      ///< correlation time [s]; 0 is white noise
  std::int64_t hold = 1;  ///< samples from one draw to the next
};

/// Processes with correlation times in steps of four, from a sample to well above the record. A spectrum even in
/// log T falls as 1/f (van der Ziel 1950); all that is faster than a sample is one white noise. The sum's Allan
/// deviation is B sqrt(2 ln2/pi) within 1 % for tau from ten samples to a fifth of the record.
std::vector<FlickerProcess> flicker_processes(double instability, double rate, double duration);

/// The noise of one axis at rest, sample by sample: each sample is the mean of the rate over 1/rate, as an IMU that
/// integrates gives it. Every term has a random stream of its own: switching one off leaves the others alone. White
/// noise, quantisation, random walk and the Gauss-Markov bias (stationary from the first sample on) follow
/// model_allan_variance() exactly, flicker noise within the bound of flicker_processes().
class NoiseRecord {
 public:
  /// `rate` [Hz]; `duration` [s] only says how slow flicker noise must become. Throws std::invalid_argument if a term
  /// is negative or not finite, or rate, duration or the correlation time is not positive.
  NoiseRecord(const NoiseTerms& terms, double rate, double duration, std::uint64_t seed);

  /// The next sample [u].
  double next();

 private:
  /// A bias whose value and mean over a sample are drawn together.
  struct Bias {
    double value = 0.0;      // at the sample's begin
    double decay = 1.0;      // of the value over a sample
    double mean_gain = 1.0;  // of the value in the sample's mean
    double value_noise = 0.0;
    double mean_by_value = 0.0;  // how much of value_noise is in the mean, per unit of noise
    double mean_own = 0.0;       // noise of the mean alone
    NormalStream normals;
    double next();
  };

  struct Flicker {
    NormalStream normals;
    double decay, drive;
    std::int64_t hold, left;
    double value;
  };

  double next_flicker();

  double white_, quantization_;  // deviations of a sample and of its integral over the sample's length [u]
  NormalStream white_normals_, quantization_normals_;
  double rounding_ = 0.0;  // of the integral at the sample's begin, over the sample's length [u]
  Bias markov_, walk_;
  bool has_markov_, has_walk_;
  std::vector<Flicker> flicker_;
};

}  // namespace allan_lio
