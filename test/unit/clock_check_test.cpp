// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/clock_check.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr TimeNs kEpoch = 1'700'000'000 * kNsPerSecond;

/// `seconds` of IMU at 100 Hz from `imu` on and of scans at 10 Hz from `lidar` on.
ClockCheck listen(TimeNs imu, TimeNs lidar, int seconds) {
  ClockCheck check;
  for (int i = 0; i <= 100 * seconds; ++i) check.add_imu(imu + i * kNsPerSecond / 100);
  for (int i = 0; i <= 10 * seconds; ++i) check.add_scan(lidar + i * kNsPerSecond / 10);
  return check;
}

TEST(ClockCheck, BothRangesAreNamedWhenTheyLieApart) {
  const std::string text = listen(kEpoch, 100 * kNsPerSecond, 4).trouble();
  EXPECT_NE(text.find("1700000000.000 to 1700000004.000"), std::string::npos) << text;
  EXPECT_NE(text.find("100.000 to 104.000"), std::string::npos) << text;
  EXPECT_NE(listen(kEpoch, kEpoch + 6 * kNsPerSecond, 4).trouble(), "") << "the LiDAR is ahead";
}

TEST(ClockCheck, RangesThatOverlapOrNearlySoAreNoTrouble) {
  EXPECT_EQ(listen(kEpoch, kEpoch, 60).trouble(), "");
  EXPECT_EQ(listen(kEpoch, kEpoch + 3 * kNsPerSecond, 4).trouble(), "");
  EXPECT_EQ(listen(kEpoch, kEpoch + 4 * kNsPerSecond + kNsPerSecond / 2, 4).trouble(), "");
}

TEST(ClockCheck, ItTakesSomeSecondsOfBothToTell) {
  EXPECT_EQ(listen(kEpoch, 0, 2).trouble(), "");
  ClockCheck one_sensor;
  for (int i = 0; i < 1000; ++i) one_sensor.add_imu(kEpoch + i * kNsPerSecond);
  EXPECT_EQ(one_sensor.trouble(), "");
}

TEST(ClockCheck, WhatCameBeforeAUsedScanIsForgotten) {
  ClockCheck check = listen(kEpoch, 0, 4);
  check.begin_again();
  EXPECT_EQ(check.trouble(), "");
}

}  // namespace
}  // namespace allan_lio
