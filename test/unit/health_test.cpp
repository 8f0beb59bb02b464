// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/health.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr TimeNs kScanStep = 100'000'000;  // [ns]
constexpr double kQuick = 0.002;           // [s] of CPU per scan

LioResult scan(int i, double nis = 6.0, ScanOutcome outcome = ScanOutcome::kUpdated) {
  LioResult result;
  result.state.nav.stamp = i * kScanStep;
  result.outcome = outcome;
  const bool updated = outcome == ScanOutcome::kUpdated;
  result.innovation.dof = updated ? 6 : 0;
  result.innovation.nis = updated ? nis : 0.0;
  return result;
}

struct Watched {
  HealthWindow window;
  LioResult last;
  explicit Watched(int scans, double nis = 6.0, double seconds = kQuick) {
    for (int i = 0; i < scans; ++i) add(scan(i, nis), seconds);
  }
  void add(const LioResult& result, double seconds = kQuick) { window.add(last = result, seconds); }
  Health judge(const HealthFacts& facts = {}) const { return judge_health(window, last, facts); }
};

void expect(const Health& health, HealthLevel level, const std::string& words) {
  EXPECT_EQ(health.level, level) << health.message;
  EXPECT_NE(health.message.find(words), std::string::npos) << health.message;
}

TEST(Health, an_honest_filter_is_well_and_its_nis_lies_in_the_band_of_its_window) {
  const Watched run(150);
  expect(run.judge(), HealthLevel::kOk, "follows");
  const NisWindow nis = run.window.nis();
  EXPECT_EQ(nis.scans, static_cast<int>(HealthWindow::kScans));
  EXPECT_DOUBLE_EQ(nis.mean, 1.0);
  // chi^2 of 600 degrees of freedom: 95 % between 534.0 and 669.8 (tables).
  EXPECT_NEAR(600 * nis.low, 534.0, 0.1);
  EXPECT_NEAR(600 * nis.high, 669.8, 0.1);
}

TEST(Health, a_run_that_found_its_place_aside_says_how_far) {
  Watched run(150);
  LioResult result = scan(150);
  result.relocated[4] = -0.72;
  run.add(result);
  expect(run.judge(), HealthLevel::kWarn, "come back 0.72 m and 0.00 deg aside");
}

TEST(Health, before_the_first_update_nothing_is_said_of_the_nis) {
  const Watched run(0);
  EXPECT_EQ(run.window.nis().scans, 0);
  EXPECT_EQ(run.window.nis().high, 0.0);
  EXPECT_EQ(run.window.scan_interval(), 0.0);
}

TEST(Health, a_filter_that_is_too_sure_is_told_to_raise_k_but_not_by_a_few_scans) {
  expect(Watched(100, 9.0).judge(), HealthLevel::kWarn, "raise k");
  expect(Watched(5, 60.0).judge(), HealthLevel::kOk, "follows");
  expect(Watched(100, 3.0).judge(), HealthLevel::kOk, "follows");
}

TEST(Health, scans_of_no_use_are_a_warning_and_in_a_row_an_error) {
  Watched run(50);
  run.add(scan(50, 0, ScanOutcome::kTooFewPoints));
  expect(run.judge(), HealthLevel::kWarn, "too few points");
  for (int i = 51; i < 55; ++i) run.add(scan(i, 0, ScanOutcome::kTooFewMatches));
  expect(run.judge(), HealthLevel::kError, "last 5 scans");
  run.add(scan(55, 0, ScanOutcome::kMapRestarted));
  expect(run.judge(), HealthLevel::kWarn, "started anew");
  run.add(scan(56));
  expect(run.judge(), HealthLevel::kOk, "follows");
}

TEST(Health, weak_axes_delay_slowness_and_losses_are_said_together) {
  Watched run(60, 6.0, 0.15);
  run.last.localizability.support[0] = 0.1;
  HealthFacts facts;
  facts.delay = 0.8;
  facts.newly_lost = 3;
  facts.lost_because = "imu: gaps";
  const Health health = run.judge(facts);
  for (const char* words : {"1 of 6 directions", "0.8 s behind",
                            "150 ms of CPU per scan, one every 100 ms (lidar/max_registered", "3 lost: imu: gaps"})
    expect(health, HealthLevel::kWarn, words);
}

TEST(Health, losses_are_listed_by_reason_and_only_those_that_came_up) {
  LioCounters counters;
  EXPECT_TRUE(count_losses(counters, 0).empty());
  counters.scans_too_few_matches = 2;
  counters.imu_dropped_invalid = 7;
  const std::vector<LossCount> losses = count_losses(counters, 1);
  ASSERT_EQ(losses.size(), 3U);
  EXPECT_EQ(losses[0].reason, "clouds: undecodable");
  EXPECT_EQ(losses[1].reason, "scans: too_few_matches");
  EXPECT_EQ(losses[2].count, 7U);
}

TEST(Health, results_that_do_not_reach_the_disk_are_a_warning) {
  HealthFacts facts;
  facts.output_trouble = "trajectory.tum: could not be written";
  expect(Watched(50).judge(facts), HealthLevel::kWarn, facts.output_trouble);
}

}  // namespace
}  // namespace allan_lio
