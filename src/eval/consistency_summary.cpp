// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "allan_lio/calib/chi_square.h"
#include "allan_lio/eval/consistency.h"

namespace allan_lio {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kTail = 0.025;         // beyond either end of a 95 % band
constexpr double kTwoSided = 1.959964;  // of the normal distribution
constexpr double kSupported = 0.5;      // support below which a direction is left to the IMU
constexpr double kShortestBlind = 2.0;  // [s]
constexpr double kBridged = 1.0;        // scans with support inside a stretch that do not end it [s]

/// 95 % band of a chi^2 variable over its degrees of freedom; the quantiles are found once each.
class Bands {
 public:
  std::pair<double, double> of(double dof) {
    const auto found = bands_.find(dof);
    if (found != bands_.end()) return found->second;
    return bands_[dof] = {chi_square_quantile(kTail, dof) / dof, chi_square_quantile(1.0 - kTail, dof) / dof};
  }

 private:
  std::map<double, std::pair<double, double>> bands_;
};

/// For every time that all runs have, the index of its sample in each.
std::vector<std::vector<std::size_t>> common_times(const std::vector<ConsistencySeries>& runs) {
  std::map<TimeNs, std::vector<std::size_t>> by_time;
  for (const ConsistencySeries& run : runs)
    for (std::size_t i = 0; i < run.size(); ++i) by_time[run[i].stamp].push_back(i);
  std::vector<std::vector<std::size_t>> times;
  for (auto& [stamp, indices] : by_time)
    if (indices.size() == runs.size()) times.push_back(std::move(indices));
  if (times.empty()) throw std::runtime_error("the runs have no time in common");
  return times;
}

NeesSummary summarize_block(NeesBlock block, const std::vector<ConsistencySeries>& runs,
                            const std::vector<std::vector<std::size_t>>& times) {
  const auto b = static_cast<std::size_t>(block);
  NeesSummary summary;
  summary.block = block;
  Bands bands;
  double sum = 0.0, sum_dof = 0.0;
  std::size_t judged = 0, inside = 0;
  for (const std::vector<std::size_t>& indices : times) {
    double nees = 0.0, dof = 0.0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
      const ConsistencySample& sample = runs[r][indices[r]];
      if (std::isnan(sample.nees[b])) continue;
      nees += sample.nees[b];
      dof += sample.dof[b];
      ++summary.samples;
    }
    if (dof <= 0.0) continue;
    const auto [low, high] = bands.of(dof);
    ++judged;
    inside += nees / dof >= low && nees / dof <= high;
    sum += nees;
    sum_dof += dof;
  }
  if (judged == 0) return summary;
  summary.mean = sum / sum_dof;
  summary.inside = static_cast<double>(inside) / static_cast<double>(judged);
  std::tie(summary.low, summary.high) = bands.of(sum_dof / static_cast<double>(judged));
  return summary;
}

double three_sigma_share(const std::vector<ConsistencySeries>& runs) {
  std::size_t judged = 0, held = 0;
  for (const ConsistencySeries& run : runs)
    for (const ConsistencySample& sample : run) {
      if (!(sample.sigma_along > 0.0)) continue;
      ++judged;
      held += std::abs(sample.along) <= 3.0 * sample.sigma_along;
    }
  return judged > 0 ? static_cast<double>(held) / static_cast<double>(judged) : kNaN;
}

/// The last scan without support of the stretch that begins at `first`.
std::size_t last_without_support(const ConsistencySeries& run, std::size_t first) {
  std::size_t last = first;
  for (std::size_t j = first; j < run.size() && seconds_between(run[last].stamp, run[j].stamp) <= kBridged; ++j)
    if (run[j].support < kSupported) last = j;
  return last;
}

std::vector<BlindStretch> blind_stretches(const ConsistencySeries& run) {
  std::vector<BlindStretch> found;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (run[i].support >= kSupported) continue;
    const std::size_t begin = i == 0 ? 0 : i - 1;
    i = last_without_support(run, i);
    const auto less_sure = [](const ConsistencySample& a, const ConsistencySample& b) {
      return a.sigma_along < b.sigma_along;
    };
    const auto first = run.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto peak = std::max_element(first, run.begin() + static_cast<std::ptrdiff_t>(i) + 1, less_sure);
    const double seconds = seconds_between(first->stamp, peak->stamp);
    if (seconds < kShortestBlind) continue;
    const double variance = peak->sigma_along * peak->sigma_along - first->sigma_along * first->sigma_along;
    found.push_back(
        {first->stamp, peak->stamp, seconds, peak->along - first->along, std::sqrt(variance), std::nullopt});
  }
  return found;
}

Whiteness whiteness(const ConsistencySeries& run) {
  Whiteness out;
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero(), squares = sum, products = sum;
  const auto known = [](const ConsistencySample& sample) { return !sample.innovation.hasNaN(); };
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < run.size(); ++i) {
    if (!known(run[i])) continue;
    ++out.samples;
    sum += run[i].innovation;
    squares += run[i].innovation.cwiseAbs2();
    if (i == 0 || !known(run[i - 1])) continue;
    ++pairs;
    products += run[i].innovation.cwiseProduct(run[i - 1].innovation);
  }
  if (pairs == 0) return Whiteness{};
  const double n = static_cast<double>(out.samples);
  for (int k = 0; k < 6; ++k) {
    const auto at = static_cast<std::size_t>(k);
    out.mean[at] = sum[k] / n;
    const double power = squares[k] / n;  // about zero, which the mean should be
    out.deviation[at] = std::sqrt(power);
    out.correlation[at] = power > 0.0 ? products[k] / static_cast<double>(pairs) / power : kNaN;
  }
  out.band = kTwoSided / std::sqrt(static_cast<double>(pairs));
  return out;
}

}  // namespace

ConsistencySummary summarize_consistency(const std::vector<ConsistencySeries>& runs) {
  const std::vector<std::vector<std::size_t>> times = common_times(runs);
  ConsistencySummary summary;
  summary.runs = runs.size();
  summary.times = times.size();
  for (int b = 0; b < kNeesBlocks; ++b)
    summary.nees[static_cast<std::size_t>(b)] = summarize_block(static_cast<NeesBlock>(b), runs, times);
  summary.three_sigma_share = three_sigma_share(runs);
  if (runs.size() == 1) {
    summary.blind = blind_stretches(runs.front());
    summary.whiteness = whiteness(runs.front());
  }
  return summary;
}

}  // namespace allan_lio
