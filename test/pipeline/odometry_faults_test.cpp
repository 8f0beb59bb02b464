// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// A sensor in a synthetic room, standing unless a test moves it: what bad data and hard starts do to the odometry.
#include <gtest/gtest.h>

#include <map>

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

TEST(OdometryFaults, ARunThatIsAsideOfItsMapAfterASilenceOfTheLidarFindsItsPlaceAndSaysSo) {
  // 8 s without scans, in which the accelerometer is off by 3 mg: 1 m, seven sigma and two voxels.
  constexpr int kFrom = 40, kUntil = 120;
  LioConfig config = default_config(mti600_spec());
  config.init.hold_standstill = false;
  config.map.insert_distance = 1e-6;  // so that the map has parts older than what comes
  for (const bool relocalize : {false, true}) {
    config.update.relocalize = relocalize;
    const Drive run = stand(
        config, 160, [](int i) { return i >= kFrom && i < kUntil ? std::nullopt : std::make_optional(room(i)); },
        [](ImuSample& sample) {
          const TimeNs since = sample.stamp - kStart;
          if (since > kFrom * kScanStep && since < kUntil * kScanStep) sample.accel.x() += 0.03;
          return true;
        });
    double aside = 0.0;
    for (const LioResult& r : run.results) aside = std::max(aside, r.relocated.tail<3>().norm());
    if (relocalize) {
      EXPECT_LT(strayed(run.results.back()), 0.03);
      EXPECT_LT(run.results.back().state.nav.velocity_world.norm(), 0.02);
      EXPECT_EQ(run.counters.places_found, 1u);
      EXPECT_NEAR(aside, 1.0, 0.2);
    } else {
      EXPECT_GT(strayed(run.results.back()), 0.4) << "it has made its walls anew";
      EXPECT_EQ(run.counters.places_found, 0u);
      EXPECT_EQ(aside, 0.0);
    }
  }
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

/// Of a sensor in g that stands: its reading, but for the ones at these indices, which read so many g along z.
std::vector<ImuSample> standing_in_g(int count, const std::map<int, double>& glitches) {
  std::vector<ImuSample> samples;
  for (int k = 0; k < count; ++k) {
    const auto found = glitches.find(k);
    samples.push_back(
        {kStart - 20'000'000 + k * kImuStep, {0, 0, 0}, {0, 0, found == glitches.end() ? 1.0 : found->second}});
  }
  return samples;
}

/// Scan by scan, each after so much of the IMU's data.
Drive feed(const LioConfig& config, const std::vector<ImuSample>& imu, std::size_t samples_ahead) {
  Odometry odometry(config);
  Drive run;
  std::size_t next = 0;
  for (int i = 0; i < 30; ++i) {
    const Scan scan = scan_of(kStart + i * kScanStep, room(i));
    const auto up_to = [&](TimeNs t) { return next < imu.size() && imu[next].stamp <= t; };
    while (up_to(scan.end()) || next < samples_ahead) odometry.add_imu(imu[next++]);
    odometry.add_scan(scan);
    while (auto result = odometry.next()) run.results.push_back(*result);
  }
  for (; next < imu.size(); ++next) odometry.add_imu(imu[next]);
  odometry.end_of_data();
  while (auto result = odometry.next()) run.results.push_back(*result);
  run.counters = odometry.counters();
  EXPECT_EQ(odometry.accel_scale(), config.imu.gravity);
  return run;
}

void expect_same_bits(const Drive& a, const Drive& b) {
  ASSERT_EQ(a.results.size(), b.results.size());
  for (std::size_t i = 0; i < a.results.size(); ++i) {
    EXPECT_EQ(a.results[i].state.nav.T_world_imu.translation, b.results[i].state.nav.T_world_imu.translation) << i;
    EXPECT_EQ(a.results[i].covariance, b.results[i].covariance) << i;
  }
}

TEST(OdometryFaults, AnAbsurdReadingOfASensorInGHidesNeitherItsUnitNorItself) {
  constexpr int kSamples = 640, kAtTheStart = 50, kUnderWay = 400;
  for (const AccelUnit unit : {AccelUnit::kAuto, AccelUnit::kG}) {
    LioConfig config = default_config(mti600_spec());
    config.imu.accel_unit = unit;
    std::vector<ImuSample> without = standing_in_g(kSamples, {});
    for (const int k : {kUnderWay, kAtTheStart, 0}) without.erase(without.begin() + k);
    const Drive clean = feed(config, without, 0);
    EXPECT_EQ(clean.counters.imu_dropped_invalid, 0u);
    EXPECT_GE(clean.counters.scans_used, 28u);
    EXPECT_LT(strayed(clean.results.back()), 0.05);
    // The first one of all; one of the second that tells the unit; one that comes when the unit is known, or before if
    // the IMU's data is far ahead.
    const std::vector<ImuSample> with = standing_in_g(kSamples, {{0, 51}, {kAtTheStart, 450}, {kUnderWay, -60}});
    for (const std::size_t ahead : {std::size_t{0}, with.size()}) {
      const Drive run = feed(config, with, ahead);
      EXPECT_EQ(run.counters.imu_dropped_invalid, 3u);
      expect_same_bits(run, clean);
    }
  }
}

}  // namespace
}  // namespace allan_lio
