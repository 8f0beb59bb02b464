// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// lidar/max_registered: a bound on the points of a scan that are registered.
#include <gtest/gtest.h>

#include <string>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/live_parameters.h"
#include "allan_lio/lidar/thin_scan.h"
#include "allan_lio/lio/odometry.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr int kMost = 250;              // of 600 to 900 a scan
constexpr int kNeverReached = 1000000;  // points
constexpr double kAteBound = 0.005;     // [m]; 0.0027 measured, all points: 0.002
constexpr std::size_t kChangedAfter = 40;

struct BudgetRun {
  std::vector<LioResult> results;
  std::uint64_t over_budget = 0;
};

const SimulatedDrive& drive() {
  static const SimulatedDrive simulated = simulate_drive("rooms", 10.0, 1);
  return simulated;
}

/// The whole drive under a bound that is raised or lowered to `later` after kChangedAfter results.
BudgetRun run(const std::vector<Scan>& scans, int most, int later) {
  LioConfig config = simulated_robot();
  config.lidar.max_registered = most;
  Odometry odometry(config);
  BudgetRun out;
  for (const ImuSample& sample : drive().imu) odometry.add_imu(sample);
  for (const Scan& scan : scans) {
    odometry.add_scan(scan);
    while (auto result = odometry.next()) {
      out.results.push_back(*result);
      if (out.results.size() == kChangedAfter)
        odometry.reconfigure(change_live(config, "lidar/max_registered", {{std::to_string(later)}, false, "a test"}));
    }
  }
  odometry.end_of_data();
  while (auto result = odometry.next()) out.results.push_back(*result);
  out.over_budget = odometry.counters().points_over_budget;
  return out;
}

BudgetRun run(int most) { return run(drive().scans, most, most); }

const BudgetRun& without_bound() {
  static const BudgetRun made = run(0);
  return made;
}

const BudgetRun& bounded() {
  static const BudgetRun made = run(kMost);
  return made;
}

void expect_same_bits(const BudgetRun& a, const BudgetRun& b) {
  ASSERT_EQ(a.results.size(), b.results.size());
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    const NavState &nav_a = a.results[i].state.nav, &nav_b = b.results[i].state.nav;
    EXPECT_EQ(a.results[i].registered, b.results[i].registered) << i;
    EXPECT_EQ(nav_a.T_world_imu.translation, nav_b.T_world_imu.translation) << i;
    EXPECT_EQ(nav_a.T_world_imu.rotation.coeffs(), nav_b.T_world_imu.rotation.coeffs()) << i;
    EXPECT_EQ(a.results[i].covariance, b.results[i].covariance) << i;
  }
}

TEST(RegistrationBudget, NoScanRegistersMoreAndWhatIsLeftOutIsCounted) {
  ASSERT_EQ(bounded().results.size(), without_bound().results.size());
  ASSERT_GT(bounded().results.size(), 90U);
  std::uint64_t left_out = 0;
  for (std::size_t i = 0; i < bounded().results.size(); ++i) {
    const int all = without_bound().results[i].registered;
    ASSERT_GT(all, kMost) << "the bound is not reached";
    EXPECT_EQ(bounded().results[i].registered, kMost);
    left_out += static_cast<std::uint64_t>(all - kMost);
  }
  EXPECT_EQ(bounded().over_budget, left_out);
  EXPECT_EQ(without_bound().over_budget, 0U);
}

TEST(RegistrationBudget, WithoutABoundAndWithOneThatIsNeverReachedTheBitsAreTheSame) {
  EXPECT_EQ(simulated_robot().lidar.max_registered, 0);
  const BudgetRun never_reached = run(kNeverReached);
  EXPECT_EQ(never_reached.over_budget, 0U);
  expect_same_bits(never_reached, without_bound());
}

TEST(RegistrationBudget, ABoundedRunIsTheSameEveryTimeAndOfThinnedScansToo) {
  const LioConfig config = simulated_robot();
  ScanDownsampler downsampler;
  std::vector<Scan> thinned;
  for (const Scan& scan : drive().scans)
    thinned.push_back(thin_scan(scan, config.map.insert_leaf, config.lidar.leaf, downsampler));
  expect_same_bits(run(kMost), bounded());
  expect_same_bits(run(thinned, kMost, kMost), bounded());
}

TEST(RegistrationBudget, ABoundedRunIsAlmostAsGood) {
  for (const LioResult& result : bounded().results) EXPECT_NE(result.outcome, ScanOutcome::kTooFewMatches);
  const TrajectoryError error = evaluate_trajectory(drive().truth, trajectory_of(bounded().results), Alignment::kSe3);
  EXPECT_LT(error.translation.rmse, kAteBound);
}

TEST(RegistrationBudget, AnotherBoundIsInForceWithTheNextScan) {
  const BudgetRun changed = run(drive().scans, 0, kMost);
  ASSERT_GT(changed.results.size(), kChangedAfter);
  EXPECT_GT(changed.results[kChangedAfter - 1].registered, kMost);
  EXPECT_EQ(changed.results[kChangedAfter].registered, kMost);
}

}  // namespace
}  // namespace allan_lio
