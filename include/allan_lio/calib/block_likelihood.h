// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "allan_lio/calib/allan_fit.h"

namespace allan_lio {

/// A level of the Haar pyramid: differences of the means of neighbouring halves, each sample used once.
struct HaarLevel {
  double tau = 0.0;        ///< length of a half [s]
  double variance = 0.0;   ///< half the mean square of the differences: an Allan variance [u^2]
  std::int64_t count = 0;  ///< differences
};

/// A record cut into blocks of 2^L samples: what the means of the blocks and the pyramid inside them say.
/// The two together are an orthogonal transform of the samples (Percival and Walden 2000, section 4.1).
struct BlockedRecord {
  double block_time = 1.0;          ///< [s]
  std::vector<double> means;        ///< of the blocks, one piece after the other [u]
  std::vector<std::size_t> starts;  ///< index of each piece's first mean
  std::vector<HaarLevel> levels;    ///< from one sample up; what a piece has left beyond its last block counts too
};

/// `halvings` is L.
BlockedRecord block_record(const IntegratedSeries& series, int halvings);

/// ln L of the blocks' means, up to a constant: the exact Gaussian likelihood by prediction errors (Harvey 1989,
/// section 3.4). State at a block's begin: Gauss-Markov bias, random walk, rounding of the integral. In each piece the
/// bias starts stationary and the random walk from anywhere (flat prior). `terms.instability` is not looked at.
/// If `innovations` is given, the standardised prediction errors are put there.
double block_log_likelihood(const BlockedRecord& record, const NoiseTerms& terms,
                            std::vector<double>* innovations = nullptr);

/// ln L of the pyramid against its largest possible value, as if its differences were independent of each other, each
/// of variance 2 sigma^2(tau): true of white noise, and nearly so while the block is short against T_b. A level whose
/// variance the model only gives within the share `model_error` weighs as if it had so many fewer differences.
double haar_log_likelihood(const std::vector<HaarLevel>& levels, const NoiseTerms& terms, double model_error = 0.0);

/// The square of a level's relative standard error, 2/count + model_error^2.
double squared_error(const HaarLevel& level, double model_error);

/// The pyramid of values (each piece of `starts` by itself) whose spacing is `spacing` [s].
std::vector<HaarLevel> haar_pyramid(const std::vector<double>& values, const std::vector<std::size_t>& starts,
                                    double spacing);

}  // namespace allan_lio
