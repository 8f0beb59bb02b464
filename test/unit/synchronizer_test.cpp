// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/synchronizer.h"

#include <gtest/gtest.h>

#include <limits>

namespace allan_lio {
namespace {

constexpr TimeNs kMs = 1'000'000;

ImuSample imu(TimeNs ms) { return {ms * kMs, Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 0, 9.8)}; }

Scan scan(TimeNs begin_ms, int length_ms = 100) {
  Scan s;
  s.stamp = begin_ms * kMs;
  s.last_offset_ns = static_cast<std::int32_t>(length_ms * kMs);
  s.points.push_back({1, 2, 3, 0, 0});
  return s;
}

TEST(Synchronizer, HandsOutAScanOnlyWhenTheImuReachesItsEnd) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_imu(imu(0));
  sync.add_scan(scan(10));
  sync.add_imu(imu(109));
  EXPECT_FALSE(sync.take());
  sync.add_imu(imu(110));
  EXPECT_TRUE(sync.take());
  EXPECT_FALSE(sync.take());
}

TEST(Synchronizer, ScansBeforeTheFirstImuSampleAreCountedNotUsed) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_scan(scan(0));
  sync.add_scan(scan(100));
  sync.add_imu(imu(50));
  sync.add_imu(imu(250));
  const auto taken = sync.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->stamp, 100 * kMs);
  EXPECT_EQ(counters.scans_before_imu, 1u);
}

TEST(Synchronizer, OldRepeatedAndSenselessDataIsDroppedAndCounted) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_imu(imu(10));
  sync.add_imu(imu(10));
  sync.add_imu(imu(5));
  ImuSample nan = imu(20);
  nan.gyro.x() = std::numeric_limits<double>::quiet_NaN();
  sync.add_imu(nan);
  ImuSample infinite = imu(20);
  infinite.accel.z() = std::numeric_limits<double>::infinity();
  sync.add_imu(infinite);
  ImuSample absurd = imu(20);
  absurd.gyro.y() = 101.0;
  sync.add_imu(absurd);
  EXPECT_EQ(counters.imu_dropped_order, 2u);
  EXPECT_EQ(counters.imu_dropped_invalid, 3u);
  EXPECT_EQ(sync.imu().size(), 1u);
  sync.add_scan(scan(100));
  sync.add_scan(scan(100));
  sync.add_scan(scan(50));
  EXPECT_EQ(counters.scans_dropped_order, 2u);
}

TEST(Synchronizer, WhatIsAbsurdInTheUnitThatIsLearntLaterIsDroppedAndCountedThen) {
  const auto in_g = [](TimeNs ms, double g) { return ImuSample{ms * kMs, {0, 0, 0}, {0, 0, g}}; };
  LioCounters counters;
  Synchronizer sync(counters);
  for (const ImuSample& sample : {in_g(0, 450), in_g(10, 1), in_g(20, -51), in_g(30, 49)}) sync.add_imu(sample);
  sync.add_scan(scan(5, 10));
  EXPECT_EQ(counters.imu_dropped_invalid, 0u);
  EXPECT_NE(sync.front(), nullptr);
  EXPECT_EQ(sync.set_accel_scale(9.80665), 2u);
  EXPECT_EQ(counters.imu_dropped_invalid, 2u);
  EXPECT_EQ(sync.imu().oldest(), 10 * kMs);
  EXPECT_EQ(sync.imu().size(), 2u);
  EXPECT_EQ(sync.front(), nullptr) << "the first reading that counts is later than the scan's begin";
  EXPECT_EQ(counters.scans_before_imu, 1u);
  sync.add_imu(in_g(40, 51));
  EXPECT_EQ(counters.imu_dropped_invalid, 3u);
  EXPECT_EQ(sync.set_accel_scale(9.80665), 0u);
}

TEST(Synchronizer, OneStampFarAheadIsDroppedAndARealGapIsNot) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_imu(imu(0));
  sync.add_imu(imu(3'600'000));
  sync.add_imu(imu(10));
  sync.add_imu(imu(20));
  EXPECT_EQ(sync.imu().newest(), 20 * kMs);
  EXPECT_EQ(counters.imu_dropped_order, 1u);
  sync.add_imu(imu(5000));
  sync.add_imu(imu(5010));
  EXPECT_EQ(sync.imu().newest(), 5010 * kMs);
  EXPECT_EQ(sync.imu().size(), 5u);
  EXPECT_EQ(counters.imu_dropped_order, 1u);
}

TEST(Synchronizer, OneScanFarAheadIsDroppedAndARealGapIsNot) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_imu(imu(0));
  for (TimeNs ms = 100; ms <= 9000; ms += 100) sync.add_imu(imu(ms));
  sync.add_scan(scan(0));
  sync.add_scan(scan(1'000'000));
  for (const TimeNs ms : {100, 200, 5000, 5100}) sync.add_scan(scan(ms));
  for (const TimeNs ms : {0, 100, 200, 5000, 5100}) {
    const std::optional<Scan> taken = sync.take();
    ASSERT_TRUE(taken) << ms;
    EXPECT_EQ(taken->stamp, ms * kMs);
  }
  EXPECT_EQ(counters.scans_dropped_order, 1U);
}

TEST(Synchronizer, AScanFarAheadThatIsTheLastOneIsKept) {
  LioCounters counters;
  Synchronizer sync(counters);
  for (TimeNs ms = 0; ms <= 6000; ms += 100) sync.add_imu(imu(ms));
  sync.add_scan(scan(0));
  sync.add_scan(scan(5000));
  EXPECT_TRUE(sync.take());
  EXPECT_FALSE(sync.take());
  sync.end_of_data();
  EXPECT_TRUE(sync.take());
}

TEST(Synchronizer, BeginningAgainForgetsWhatWasBeforeAndTakesTheScanBack) {
  LioCounters counters;
  Synchronizer sync(counters);
  for (const TimeNs ms : {0, 10, 3000, 3010, 3200}) sync.add_imu(imu(ms));
  sync.add_scan(scan(2950));
  sync.add_scan(scan(3050));
  std::optional<Scan> taken = sync.take();
  ASSERT_TRUE(taken);
  sync.begin_again(3000 * kMs, std::move(*taken));
  EXPECT_EQ(sync.imu().oldest(), 3000 * kMs);
  taken = sync.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->stamp, 3050 * kMs) << "the other began in the silence";
  EXPECT_EQ(counters.scans_before_imu, 1U);
}

TEST(Synchronizer, TheBufferIsBoundedWhileNoScanComes) {
  LioCounters counters;
  Synchronizer sync(counters);
  for (int i = 0; i < 1'000'000; i += 100) sync.add_imu(imu(i));
  EXPECT_LE(sync.imu().size(), 6002u);
}

TEST(Synchronizer, TheEndOfTheDataBridgesAShortLackAndGivesUpOnALongOne) {
  LioCounters counters;
  Synchronizer sync(counters);
  sync.add_imu(imu(0));
  sync.add_imu(imu(90));
  sync.add_scan(scan(0));
  sync.add_scan(scan(100));
  sync.add_scan(scan(200));
  EXPECT_FALSE(sync.take());
  sync.end_of_data();
  EXPECT_TRUE(sync.take()) << "10 ms are missing";
  EXPECT_FALSE(sync.take()) << "110 ms are missing";
  EXPECT_EQ(counters.scans_after_imu, 2u);
}

}  // namespace
}  // namespace allan_lio
