// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A sensor in a synthetic room, standing unless a test moves it: what bad data and hard starts do to the odometry.
#include <gtest/gtest.h>

#include "room_stand.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

TEST(OdometryFaults, AStandstillStaysWhereItIs) {
  const Drive run = stand(default_config(mti600_spec()), 40, room);
  EXPECT_EQ(run.counters.scans_used, 40u);
  for (const LioResult& r : run.results) EXPECT_LT(strayed(r), 0.01);
}

TEST(OdometryFaults, AThinFirstScanDoesNotLockTheFilterOut) {
  const Drive run = stand(default_config(mti600_spec()), 40,
                          [](int i) { return room_points(i == 0 ? 400 : 20000, 0.02, 7u + static_cast<unsigned>(i)); });
  EXPECT_GE(run.counters.scans_used, 35u);
  EXPECT_EQ(run.results.back().outcome, ScanOutcome::kUpdated);
  EXPECT_LT(strayed(run.results.back()), 0.05);
}

TEST(OdometryFaults, NewSurroundingsStartANewMapAfterASecond) {
  const auto elsewhere = [](int i) {
    std::vector<Eigen::Vector3d> points = room(i);
    if (i >= 20)
      for (Eigen::Vector3d& p : points) p += Eigen::Vector3d(30.0, 20.0, 0.0);
    return points;
  };
  const Drive run = stand(default_config(mti600_spec()), 60, elsewhere);
  EXPECT_EQ(run.counters.map_restarts, 1u);
  EXPECT_EQ(run.results.back().outcome, ScanOutcome::kUpdated);
  for (const LioResult& r : run.results) EXPECT_TRUE(is_finite(r));
}

TEST(OdometryFaults, AStandstillInACorridorTakesUpNoVelocity) {
  const Drive run = stand(default_config(mti600_spec()), 60, [](int i) {
    return corridor_points(20000, 0.02, static_cast<unsigned>(i) * 100, i == 0 ? 1.5 : 1.0);
  });
  // Nothing tells of x but the standstill at the start: 0.05 m/s of it, for 6 s.
  EXPECT_LT(std::abs(run.results.back().state.nav.velocity_world.x()), 0.05);
  EXPECT_LT(strayed(run.results.back()), 0.3);
}

TEST(OdometryFaults, EmptyScansLeaveItToTheImu) {
  const Drive run = stand(default_config(mti600_spec()), 30,
                          [](int i) { return i == 0 || i == 12 ? std::vector<Eigen::Vector3d>{} : room(i); });
  EXPECT_EQ(run.counters.scans_too_few_points, 2u);
  EXPECT_EQ(run.counters.scans_used, 28u);
  EXPECT_LT(strayed(run.results.back()), 0.05);
}

TEST(OdometryFaults, AFirstScanWithoutDurationMakesNoNaNInAnyDiscretization) {
  for (const Discretization method :
       {Discretization::kEuler, Discretization::kTrapezoid, Discretization::kDiscrete, Discretization::kVanLoan}) {
    LioConfig config = default_config(mti600_spec());
    config.imu.discretization = method;
    Odometry odometry(config);
    for (TimeNs t = kStart; t < kStart + 2'000'000'000; t += kImuStep)
      odometry.add_imu({t, {0, 0, 0}, {0, 0, 9.80665}});
    for (int i = 0; i < 10; ++i) odometry.add_scan(scan_of(kStart + i * kScanStep, room(i), 0));
    odometry.end_of_data();
    int count = 0;
    for (; auto result = odometry.next(); ++count) EXPECT_TRUE(is_finite(*result));
    EXPECT_EQ(count, 10);
  }
}

TEST(OdometryFaults, TheResultDoesNotDependOnHowTheStreamsInterleave) {
  const LioConfig config = default_config(mti600_spec());
  std::vector<std::vector<LioResult>> runs;
  for (const int lead : {0, 3, 15}) {  // scans that arrive before their IMU data
    Odometry odometry(config);
    runs.emplace_back();
    const auto drain = [&] {
      while (auto result = odometry.next()) runs.back().push_back(*result);
    };
    int next_scan = 0;
    for (int k = 0; k < 600; ++k) {
      const TimeNs t = kStart - 20'000'000 + k * kImuStep;
      while (next_scan < 28 && kStart + (next_scan - lead) * kScanStep <= t)
        odometry.add_scan(scan_of(kStart + next_scan * kScanStep, room(next_scan))), ++next_scan;
      odometry.add_imu({t, {0.01 * std::sin(0.1 * k), 0, 0}, {0.1 * std::cos(0.2 * k), 0, 9.80665}});
      drain();
    }
    odometry.end_of_data();
    drain();
  }
  ASSERT_EQ(runs[0].size(), 28u);
  for (const auto& run : runs) {
    ASSERT_EQ(run.size(), runs[0].size());
    for (std::size_t i = 0; i < run.size(); ++i) {
      EXPECT_EQ(run[i].state.nav.T_world_imu.translation, runs[0][i].state.nav.T_world_imu.translation);
      EXPECT_EQ(run[i].covariance, runs[0][i].covariance);
    }
  }
}

}  // namespace
}  // namespace allan_lio
