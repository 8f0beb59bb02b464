// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "allan_lio/lidar/thin_scan.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

SimulatedDrive thinned(SimulatedDrive drive, const LioConfig& config) {
  ScanDownsampler downsampler;
  for (Scan& scan : drive.scans) scan = thin_scan(scan, config.map.insert_leaf, config.lidar.leaf, downsampler);
  return drive;
}

void expect_same_bits(const LioResult& a, const LioResult& b) {
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.scan_begin, b.scan_begin);
  EXPECT_EQ(a.state.nav.stamp, b.state.nav.stamp);
  EXPECT_EQ(a.state.nav.T_world_imu.translation, b.state.nav.T_world_imu.translation);
  EXPECT_EQ(a.state.nav.T_world_imu.rotation.coeffs(), b.state.nav.T_world_imu.rotation.coeffs());
  EXPECT_EQ(a.state.nav.velocity_world, b.state.nav.velocity_world);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.registered, b.registered);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.innovation.nis, b.innovation.nis);
  EXPECT_EQ(a.innovation.log_det, b.innovation.log_det);
}

TEST(ThinnedScans, GiveTheSameResultsAsTheWholeOnesToTheBit) {
  const SimulatedDrive drive = simulate_drive("rooms", 8.0, 3);
  for (const double leaf : {0.4, 0.15}) {
    LioConfig config = simulated_robot();
    config.lidar.leaf = leaf;
    const std::vector<LioResult> whole = run_odometry(drive, config);
    const std::vector<LioResult> thin = run_odometry(thinned(drive, config), config);
    ASSERT_GT(whole.size(), 70U);
    ASSERT_EQ(thin.size(), whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i) expect_same_bits(thin[i], whole[i]);
  }
}

TEST(ThinnedScans, HoldNoPointThatIsNotPutToUse) {
  const SimulatedDrive drive = simulate_drive("rooms", 0.5, 3);
  ScanDownsampler downsampler;
  const Scan& whole = drive.scans.front();
  const Scan thin = thin_scan(whole, 0.1, 0.4, downsampler);
  EXPECT_LT(thin.points.size(), whole.points.size());
  EXPECT_EQ(thin.points.size() + thin.thinned_away, whole.points.size());
  EXPECT_LT(thin.registered.size(), thin.points.size());
  EXPECT_EQ(thin.begin(), whole.begin());
  EXPECT_EQ(thin.end(), whole.end());
  const Scan again = thin_scan(thin, 0.1, 0.4, downsampler);
  EXPECT_EQ(again.points.size(), thin.points.size());
  EXPECT_EQ(again.registered, thin.registered);
}

TEST(ThinnedScans, AnotherPhaseRegistersOtherPointsOfTheSameCells) {
  const SimulatedDrive drive = simulate_drive("rooms", 0.5, 3);
  ScanDownsampler downsampler;
  const Scan thin = thin_scan(drive.scans.front(), 0.1, 0.4, downsampler);
  const auto first = registered_at_phase(thin.points, 0.4, 0, downsampler);
  const auto third = registered_at_phase(thin.points, 0.4, 2, downsampler);
  EXPECT_NE(first, third);
  EXPECT_TRUE(std::is_sorted(third.begin(), third.end()));
  EXPECT_EQ(third, registered_at_phase(thin.points, 0.4, 2, downsampler));
  // A point near a border of ranges claims two cells, so the number of points is not quite that of the cells.
  EXPECT_NEAR(static_cast<double>(third.size()) / static_cast<double>(first.size()), 1.0, 0.1);
  EXPECT_LT(first.size(), thin.points.size() / 2);
}

}  // namespace
}  // namespace allan_lio
