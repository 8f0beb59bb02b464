// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/health.h"

#include <cstdio>

#include "allan_lio/calib/chi_square.h"

namespace allan_lio {
namespace {

constexpr double kLongDelay = 0.5;  // [s]
constexpr int kLostScans = 5;       // without a match in a row
constexpr double kBand = 0.95;
constexpr int kFewScans = 20;  // fewer say nothing about the filter's honesty

std::string text(const char* format, double a, double b = 0.0, double c = 0.0) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, a, b, c);
  return buffer;
}

/// Collects what is wrong and keeps the worst.
class Verdict {
 public:
  void add(HealthLevel level, const std::string& sentence) {
    if (level < health_.level) return;
    if (level > health_.level) health_.message.clear();
    health_.level = level;
    health_.message += (health_.message.empty() ? "" : "; ") + sentence;
  }
  Health take() const { return health_; }

 private:
  Health health_;
};

}  // namespace

std::vector<LossCount> count_losses(const LioCounters& c, std::uint64_t undecodable, const LostOnTheWay& lost) {
  std::vector<LossCount> losses;
  const auto add = [&losses](const char* reason, std::uint64_t count) {
    if (count > 0) losses.push_back({reason, count});
  };
  add("clouds: undecodable", undecodable);
  add("scans: lost_before_arrival", lost.scans);
  add("scans: not_newer_than_the_last", c.scans_dropped_order);
  add("scans: before_first_imu", c.scans_before_imu);
  add("scans: after_last_imu", c.scans_after_imu);
  add("scans: too_few_points", c.scans_too_few_points);
  add("scans: too_few_matches", c.scans_too_few_matches);
  add("scans: imu_did_not_come", c.scans_overflow);
  add("imu: lost_before_arrival", lost.imu);
  add("imu: dropped_not_newer", c.imu_dropped_order);
  add("imu: dropped_invalid", c.imu_dropped_invalid);
  add("imu: saturated", c.imu_saturated);
  add("imu: gaps", c.imu_gaps);
  add("points: invalid", c.points_invalid);
  add("points: out_of_range", c.points_out_of_range);
  add("points: over_budget", c.points_over_budget);
  return losses;
}

void HealthWindow::add(const LioResult& result, double seconds) {
  const bool unmatched = result.outcome == ScanOutcome::kTooFewPoints || result.outcome == ScanOutcome::kTooFewMatches;
  unmatched_ = unmatched ? unmatched_ + 1 : 0;
  scans_.push_back({result.state.nav.stamp, result.innovation.nis, result.innovation.dof, seconds});
  if (scans_.size() > kScans) scans_.pop_front();
}

void HealthWindow::clear() {
  scans_.clear();
  unmatched_ = 0;
}

NisWindow HealthWindow::nis() const {
  NisWindow window;
  double sum = 0.0, dof = 0.0;
  for (const Entry& scan : scans_) {
    if (scan.dof == 0) continue;
    ++window.scans;
    sum += scan.nis;
    dof += scan.dof;
  }
  if (window.scans == 0) return window;
  window.mean = sum / dof;
  window.low = chi_square_quantile(0.5 * (1.0 - kBand), dof) / dof;
  window.high = chi_square_quantile(0.5 * (1.0 + kBand), dof) / dof;
  return window;
}

double HealthWindow::mean_seconds() const {
  double sum = 0.0;
  for (const Entry& scan : scans_) sum += scan.seconds;
  return scans_.empty() ? 0.0 : sum / static_cast<double>(scans_.size());
}

double HealthWindow::scan_interval() const {
  if (scans_.size() < 2) return 0.0;
  return seconds_between(scans_.front().stamp, scans_.back().stamp) / static_cast<double>(scans_.size() - 1);
}

int weak_axes(const Localizability& localizability) {
  return static_cast<int>((localizability.support.array() < kSupported).count());
}

std::string describe_relocation(const PoseVector& step) {
  return text("the run had come back %.2f m and %.2f deg aside of its map and was set to where the scan fits",
              step.tail<3>().norm(), step.head<3>().norm() * 180.0 / M_PI);
}

Health judge_health(const HealthWindow& window, const LioResult& last, const HealthFacts& facts) {
  Verdict verdict;
  const NisWindow nis = window.nis();
  if (window.unmatched_in_a_row() >= kLostScans)
    verdict.add(HealthLevel::kError,
                text("the last %.0f scans were of no use: the IMU goes on alone", window.unmatched_in_a_row()));
  if (window.unmatched_in_a_row() > 0)
    verdict.add(HealthLevel::kWarn, last.outcome == ScanOutcome::kTooFewPoints ? "the scan has too few points"
                                                                               : "the scan does not match the map");
  if (last.outcome == ScanOutcome::kMapRestarted) verdict.add(HealthLevel::kWarn, "the map was started anew");
  if (!last.relocated.isZero(0.0)) verdict.add(HealthLevel::kWarn, describe_relocation(last.relocated));
  const bool updated = last.outcome == ScanOutcome::kUpdated;
  if (const int weak = updated ? weak_axes(last.localizability) : 0; weak > 0)
    verdict.add(HealthLevel::kWarn, text("%.0f of 6 directions are left to the IMU", weak));
  if (nis.scans >= kFewScans && nis.mean > nis.high)
    verdict.add(HealthLevel::kWarn,
                text("the filter is too sure: mean NIS %.2f, honest up to %.2f (raise k)", nis.mean, nis.high));
  if (facts.delay > kLongDelay) verdict.add(HealthLevel::kWarn, text("%.3g s behind the sensors' stamps", facts.delay));
  if (window.scan_interval() > 0.0 && window.mean_seconds() > window.scan_interval())
    verdict.add(HealthLevel::kWarn, text("%.0f ms of CPU per scan, one every %.0f ms (lidar/max_registered bounds it)",
                                         1e3 * window.mean_seconds(), 1e3 * window.scan_interval()));
  if (facts.newly_lost > 0)
    verdict.add(HealthLevel::kWarn, text("%.0f lost: ", static_cast<double>(facts.newly_lost)) + facts.lost_because);
  if (!facts.output_trouble.empty()) verdict.add(HealthLevel::kWarn, facts.output_trouble);
  verdict.add(
      HealthLevel::kOk,
      nis.scans == 0 ? "follows" : text("follows, mean NIS %.2f (honest: %.2f to %.2f)", nis.mean, nis.low, nis.high));
  return verdict.take();
}

}  // namespace allan_lio
