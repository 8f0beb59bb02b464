// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/sweep_window.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace allan_lio {
namespace {

constexpr std::int32_t kMs = 1'000'000;  // [ns]
constexpr double kUsual = 100.0 * kMs;   // [ns]

/// A point each millisecond from 0 to `last` [ms], then `strays` points at `stray` [ms].
Scan sweep(int last, int strays, int stray) {
  Scan scan;
  for (int t = 0; t <= last; ++t) scan.points.push_back({1, 2, 3, 0, t * kMs});
  for (int i = 0; i < strays; ++i) scan.points.push_back({1, 2, 3, 0, stray * kMs});
  scan.first_offset_ns = std::min(0, stray * kMs);
  scan.last_offset_ns = std::max(last, stray) * kMs;
  return scan;
}

TEST(SweepWindow, AFewStraysAreRemovedOnEitherSide) {
  for (const int stray : {1900, 300, -400, -1900}) {
    Scan scan = sweep(99, 10, stray);
    EXPECT_EQ(drop_strays(scan, kUsual), 10U) << stray;
    EXPECT_EQ(scan.points.size(), 100U);
    EXPECT_EQ(scan.first_offset_ns, 0);
    EXPECT_EQ(scan.last_offset_ns, 99 * kMs);
  }
}

TEST(SweepWindow, ASweepThatHasReallyBecomeLongerStays) {
  Scan scan = sweep(199, 0, 0);
  EXPECT_EQ(drop_strays(scan, kUsual), 0U);
  EXPECT_EQ(scan.points.size(), 200U);
  EXPECT_EQ(scan.last_offset_ns, 199 * kMs);

  Scan sparse = sweep(99, 15, 300);
  EXPECT_EQ(drop_strays(sparse, kUsual), 0U);
  EXPECT_EQ(sparse.last_offset_ns, 300 * kMs);
}

TEST(SweepWindow, ManyPointsFarOutsideMakeTheScanRefused) {
  Scan scan = sweep(99, 15, 1900);
  EXPECT_FALSE(drop_strays(scan, kUsual));
}

TEST(SweepWindow, AScanWithoutPointsHasNoLength) {
  Scan scan;
  scan.last_offset_ns = 1900 * kMs;
  EXPECT_EQ(drop_strays(scan, kUsual), 0U);
  EXPECT_EQ(scan.last_offset_ns, 0);
}

TEST(SweepWindow, TheExtentOfManyTimesLeavesOutTheFewThatAreFarOff) {
  std::vector<double> times{1e9, -5e8};
  for (int i = 0; i < 1000; ++i) times.push_back(0.0001 * i);
  const Extent extent = extent_without_strays(times);
  EXPECT_EQ(extent.smallest, 0.0);
  EXPECT_DOUBLE_EQ(extent.largest, 0.0999);
  std::vector<double> one{3.0};
  EXPECT_EQ(extent_without_strays(one).largest, 3.0);
}

}  // namespace
}  // namespace allan_lio
