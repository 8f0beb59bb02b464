// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/stamp_check.h"

#include <algorithm>

namespace allan_lio {
namespace {

constexpr double kOneInTwenty = 0.05;

/// The value below which this part of the sorted numbers lies.
TimeNs quantile(const std::vector<TimeNs>& sorted, double part) {
  return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1) + 0.5)];
}

}  // namespace

StampReport check_stamps(const std::vector<TimeNs>& stamps) {
  StampReport report;
  report.count = stamps.size();
  if (stamps.empty()) return report;
  report.first = *std::min_element(stamps.begin(), stamps.end());
  report.last = *std::max_element(stamps.begin(), stamps.end());
  struct Step {
    TimeNs from, length;
  };
  std::vector<Step> steps;
  TimeNs newest = stamps.front();
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] <= newest) {
      ++report.not_newer;
      continue;
    }
    steps.push_back({newest, stamps[i] - newest});
    newest = stamps[i];
  }
  if (steps.empty()) return report;

  std::vector<TimeNs> sorted;
  for (const Step& step : steps) sorted.push_back(step.length);
  std::sort(sorted.begin(), sorted.end());
  const TimeNs median = quantile(sorted, 0.5);
  report.interval = 1e-9 * static_cast<double>(median);
  report.jitter = 1e-9 * static_cast<double>(std::max(quantile(sorted, 1.0 - kOneInTwenty) - median,
                                                      median - quantile(sorted, kOneInTwenty)));
  for (const Step& step : steps) {
    const double seconds = 1e-9 * static_cast<double>(step.length);
    if (seconds <= StampReport::kGap * report.interval) continue;
    ++report.gaps;
    report.lost += seconds / report.interval - 1.0;
    if (seconds <= report.longest_gap) continue;
    report.longest_gap = seconds;
    report.gap_at = step.from;
  }
  return report;
}

double median_seconds(std::vector<TimeNs> differences) {
  if (differences.empty()) return 0.0;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return 1e-9 * static_cast<double>(*middle);
}

}  // namespace allan_lio
