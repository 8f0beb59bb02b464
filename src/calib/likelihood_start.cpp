// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "likelihood_start.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "allan_lio/imu/imu_noise.h"

namespace allan_lio {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewestSamples = 256;
constexpr std::size_t kMostBlocks = 1 << 14, kMostShortBlocks = 1 << 15;
constexpr double kBlockInShortest = 8.0;  // a block in shortest times
constexpr double kAlmost = 1.0 - 1e-9;    // of a time, for rounding
constexpr double kBlocksPerTime = 8.0;    // blocks in a T_b, at least, if that is known and needs not too many

std::size_t count_samples(const IntegratedSeries& series) {
  const std::size_t pieces = std::max<std::size_t>(1, series.starts.size());
  return series.x.size() > pieces ? series.x.size() - pieces : 0;
}

int choose_halvings(std::size_t samples, double tau0, const AllanFit& start, double shortest) {
  int halvings = 0;
  while ((samples >> halvings) > kMostBlocks) ++halvings;
  const double longest = start.terms.markov_sigma > 0 ? start.terms.markov_time / kBlocksPerTime : kInfinity;
  while (halvings > 0 && std::ldexp(tau0, halvings) > longest && (samples >> (halvings - 1)) <= kMostShortBlocks)
    --halvings;
  // Some levels are needed to see whether the noise is white from there on.
  while (std::ldexp(tau0, halvings) < kBlockInShortest * shortest) ++halvings;
  return halvings;
}

/// The record's own curve over all scales: inside the blocks and between them.
std::vector<HaarLevel> whole_pyramid(const BlockedRecord& record) {
  std::vector<HaarLevel> levels = record.levels;
  const std::vector<HaarLevel> between = haar_pyramid(record.means, record.starts, record.block_time);
  levels.insert(levels.end(), between.begin(), between.end());
  return levels;
}

/// What the record can say at all, from its pyramid.
struct Magnitudes {
  double white = kInfinity;  ///< N if white noise were all, at the tau where that is least
  double largest_white = 0.0, largest_walk = 0.0, largest = 0.0, smallest = kInfinity;
  double length = 0.0;  ///< [s]
};

Magnitudes measure(const std::vector<HaarLevel>& levels) {
  Magnitudes m;
  for (const HaarLevel& level : levels) {
    const double deviation = std::sqrt(level.variance);
    if (level.count >= 8) m.white = std::min(m.white, deviation * std::sqrt(level.tau));
    if (level.count >= 8) m.smallest = std::min(m.smallest, deviation);
    m.largest_white = std::max(m.largest_white, deviation * std::sqrt(level.tau));
    m.largest_walk = std::max(m.largest_walk, deviation * std::sqrt(3.0 / level.tau));
    m.largest = std::max(m.largest, deviation);
    m.length = std::max(m.length, 2.0 * level.tau * static_cast<double>(level.count));
  }
  return m;
}

NoiseLogs inside(const LikelihoodSurface& surface, NoiseLogs logs) {
  for (int i = 0; i < kNoiseParameters; ++i) logs[i] = std::min(std::max(logs[i], surface.low[i]), surface.high[i]);
  return logs;
}

}  // namespace

LikelihoodSurface make_likelihood_surface(const IntegratedSeries& series, const AllanFit& start, double shortest) {
  const std::size_t samples = count_samples(series);
  if (samples < kFewestSamples ||
      shortest * static_cast<double>(kFewestSamples) > series.tau0 * static_cast<double>(samples))
    throw std::invalid_argument("the record is too short for a fit by likelihood: it has " + std::to_string(samples) +
                                " samples, " + std::to_string(kFewestSamples) +
                                " of the shortest time fitted are needed");
  LikelihoodSurface surface;
  surface.record = block_record(series, choose_halvings(samples, series.tau0, start, shortest));
  std::vector<HaarLevel>& inside_blocks = surface.record.levels;
  const auto too_short = [&](const HaarLevel& level) { return level.tau < kAlmost * shortest; };
  inside_blocks.erase(std::remove_if(inside_blocks.begin(), inside_blocks.end(), too_short), inside_blocks.end());
  const std::vector<HaarLevel> levels = whole_pyramid(surface.record);
  bool usable = !levels.empty() && levels.front().variance > 0;
  for (const HaarLevel& level : levels) usable = usable && std::isfinite(level.variance);
  if (!usable)
    throw std::invalid_argument("the record cannot be fitted: it does not change, or holds values that are not finite");
  const Magnitudes m = measure(levels);
  NoiseTerms low, high;
  high.quantization = 3.0 * levels.front().tau * std::sqrt(levels.front().variance / 3.0);
  low.quantization = 1e-3 * high.quantization;
  low.white = 1e-3 * m.white;
  high.white = 10.0 * m.largest_white;
  low.markov_sigma = 1e-2 * m.white / std::sqrt(m.length);
  high.markov_sigma = 100.0 * m.largest;
  low.markov_time = std::max(50.0 * series.tau0, 1e-4 * m.length);
  high.markov_time = 10.0 * m.length;
  low.random_walk = 1e-2 * m.white / m.length;
  high.random_walk = 10.0 * m.largest_walk;
  surface.low = logs_of(low);
  surface.high = logs_of(high);
  return surface;
}

std::vector<NoiseLogs> starting_points(const LikelihoodSurface& surface, const AllanFit& start) {
  const std::vector<HaarLevel> levels = whole_pyramid(surface.record);
  const Magnitudes m = measure(levels);
  NoiseTerms guess = start.terms;
  if (!(guess.white > 0)) guess.white = m.white;
  const double shortest = levels.front().tau, rest = levels.front().variance - guess.white * guess.white / shortest;
  guess.quantization = shortest * std::sqrt(std::max(rest, 0.01 * levels.front().variance) / 3.0);
  guess.random_walk = std::sqrt(3.0 * levels.back().variance / levels.back().tau) / 3.0;
  const double sigma = m.smallest / std::sqrt(4.0 * gauss_markov_peak_value());
  std::vector<NoiseLogs> points;
  if (start.terms.markov_sigma > 0) points.push_back(inside(surface, logs_of(guess)));
  for (const double share : {1e-3, 1e-2, 1e-1}) {
    guess.markov_sigma = sigma;
    guess.markov_time = std::max(share * m.length, 2.0 * surface.record.block_time);
    points.push_back(inside(surface, logs_of(guess)));
  }
  return points;
}

}  // namespace allan_lio
