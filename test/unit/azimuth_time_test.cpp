// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/azimuth_time.h"

#include <gtest/gtest.h>

#include <cmath>

namespace allan_lio {
namespace {

constexpr double kSweep = 0.1;  // [s]
constexpr int kColumns = 360, kRings = 8;
constexpr double kLookAhead = 0.1;        // [rad] of every other laser
constexpr double kAzimuthRounding = 2e3;  // [ns]

double azimuth_of(int column, int ring) { return 2.5 + 2.0 * M_PI * column / kColumns + (ring % 2) * kLookAhead; }

ScanPoint point_at(double azimuth) {
  return {static_cast<float>(8.0 * std::cos(azimuth)), static_cast<float>(8.0 * std::sin(azimuth)), 0.5F, 0.0F, 0};
}

/// A turn from `from` to `to` column by column; `sign` -1 turns clockwise.
Scan fired(int from, int to, double sign) {
  Scan scan;
  for (int column = from; column < to; ++column)
    for (int ring = 0; ring < kRings; ++ring) scan.points.push_back(point_at(sign * azimuth_of(column, ring)));
  return scan;
}

TEST(AzimuthTime, EachPointIsAsFarBehindTheFirstAsTheHeadHasTurned) {
  for (const bool clockwise : {false, true}) {
    Scan scan = fired(0, kColumns, clockwise ? -1.0 : 1.0);
    ASSERT_EQ(set_times_by_azimuth({clockwise, kSweep}, scan), "");
    for (int column = 0; column < kColumns; ++column) {
      for (int ring = 0; ring < kRings; ++ring) {
        const double turned = azimuth_of(column, ring) - azimuth_of(0, 0);
        EXPECT_NEAR(scan.points[static_cast<std::size_t>(column * kRings + ring)].offset_ns,
                    1e9 * kSweep * turned / (2.0 * M_PI), kAzimuthRounding);
      }
    }
    EXPECT_EQ(scan.first_offset_ns, 0);
    EXPECT_EQ(scan.last_offset_ns, scan.points.back().offset_ns);
  }
}

TEST(AzimuthTime, ASideWithoutReturnsIsSkipped) {
  Scan scan = fired(0, 60, 1.0);
  const Scan rest = fired(330, kColumns, 1.0);  // after three quarters of a turn without a return
  scan.points.insert(scan.points.end(), rest.points.begin(), rest.points.end());
  ASSERT_EQ(set_times_by_azimuth({false, kSweep}, scan), "");
  EXPECT_NEAR(scan.points.back().offset_ns, 1e9 * kSweep * (359.0 / kColumns + kLookAhead / (2.0 * M_PI)),
              kAzimuthRounding);
}

TEST(AzimuthTime, ThoseOfACloudSortedByRingsOrTurningTheOtherWayAreNotGuessed) {
  Scan rings;
  for (int ring = 0; ring < kRings; ++ring)
    for (int column = 0; column < kColumns; ++column) rings.points.push_back(point_at(azimuth_of(column, ring)));
  EXPECT_NE(set_times_by_azimuth({false, kSweep}, rings).find("not in the order of firing"), std::string::npos);
  Scan other = fired(0, kColumns, 1.0);
  EXPECT_NE(set_times_by_azimuth({true, kSweep}, other).find("clockwise"), std::string::npos);
  EXPECT_EQ(other.points.back().offset_ns, 0);
  Scan empty;
  EXPECT_EQ(set_times_by_azimuth({true, kSweep}, empty), "");
}

}  // namespace
}  // namespace allan_lio
