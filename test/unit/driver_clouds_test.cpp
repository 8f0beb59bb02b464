// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "allan_lio/ros/decode_cloud.h"
#include "changed_bag.h"
#include "cloud_fixture.h"

namespace allan_lio {
namespace {

using sensor_msgs::PointField;

constexpr std::size_t kPoints = 500;
constexpr double kSweep = kFixtureSweep;
constexpr TimeNs kStamp = kFixtureStamp;
constexpr double kOtherClock = 7000.0;  // [s]

LioConfig::Lidar options(PointTime told = PointTime::kAuto) {
  LioConfig::Lidar lidar{};
  lidar.deskew = true;
  lidar.point_time = told;
  lidar.time_unit = TimeUnit::kAuto;
  lidar.drop_tagged = true;
  lidar.min_range = 0.5;
  lidar.max_range = 100.0;
  return lidar;
}

std::vector<FixturePoint> points(double zero, double per_second) { return sweep_points(kPoints, zero, per_second); }

using Case = std::tuple<FixtureLayout, std::uint8_t>;
class DriverClouds : public testing::TestWithParam<Case> {};

TEST_P(DriverClouds, AreReadInEveryUnitAndAnchorThatTheirTypeHoldsAndRefusedOtherwise) {
  const auto& [layout, type] = GetParam();
  int read = 0, refused = 0;
  for (const FixtureUnit& unit : fixture_units()) {
    for (const FixtureAnchor& anchor : fixture_anchors()) {
      SCOPED_TRACE(std::string(unit.name) + " " + anchor.name);
      const double zero = anchor.zero(kStamp);
      CloudDecoder decoder(options(anchor.told));
      const DecodedCloud decoded = decoder.decode(make_cloud(layout, type, kStamp, points(zero, unit.per_second)));
      if (!holds(type, unit, anchor, kStamp)) {
        ++refused;
        EXPECT_FALSE(decoded.scan);
        EXPECT_NE(decoded.error.find("'" + layout.time_field + "'"), std::string::npos) << decoded.error;
        EXPECT_NE(decoded.error.find("; "), std::string::npos) << "no way out is named: " << decoded.error;
        continue;
      }
      ++read;
      ASSERT_TRUE(decoded.scan) << decoded.error;
      ASSERT_EQ(decoded.scan->points.size(), kPoints);
      const double tolerance = 1.0 + 1e9 * time_step(type, unit, std::abs(zero) + kSweep);  // [ns]
      for (std::size_t i = 0; i < kPoints; ++i)
        ASSERT_NEAR(decoded.scan->points[i].offset_ns, 1e9 * (anchor.begin + kSweep * sweep_part(i, kPoints)),
                    tolerance);
      EXPECT_EQ(decoded.scan->stamp, kStamp);
    }
  }
  EXPECT_GT(read, 4);
  EXPECT_EQ(read + refused, 28);
}

INSTANTIATE_TEST_SUITE_P(Layouts, DriverClouds,
                         testing::Combine(testing::ValuesIn(driver_layouts()), testing::ValuesIn(fixture_time_types())),
                         [](const testing::TestParamInfo<Case>& info) {
                           return std::get<0>(info.param).driver + "_type" + std::to_string(std::get<1>(info.param));
                         });

TEST(DriverCloud, LivoxNanosecondsOfTheClockAreTold) {
  CloudDecoder decoder(options());
  const DecodedCloud decoded = decoder.decode(make_cloud(layout_of("livox"), 0, kStamp, points(1e-9 * kStamp, 1e9)));
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_NE(decoder.verdict().find("float64 in ns of the clock"), std::string::npos) << decoder.verdict();
}

TEST(DriverCloud, AnOrganisedOusterCloudIsReadWithoutTheRaysThatMetNothing) {
  constexpr std::uint32_t kRows = 64, kColumns = 32;
  constexpr double kColumnStep = 3'000'000;  // [ns]
  std::vector<FixturePoint> rays;
  std::uint32_t lost = 0;
  for (std::uint32_t row = 0; row < kRows; ++row) {
    for (std::uint32_t column = 0; column < kColumns; ++column) {
      rays.push_back({2.0F + static_cast<float>(column), static_cast<float>(row), 0.25F, 7.0F, kColumnStep * column});
      if ((row + column) % 7 > 1) continue;
      const float nothing = (row + column) % 7 == 0 ? 0.0F : std::nanf("");
      rays.back().x = rays.back().y = rays.back().z = nothing;
      ++lost;
    }
  }
  sensor_msgs::PointCloud2 cloud = make_cloud(layout_of("ouster"), 0, kStamp, rays);
  cloud.is_dense = 1;  // it says so whatever it holds
  ASSERT_EQ(cloud.height, kRows);
  ASSERT_EQ(cloud.width, kColumns);
  const DecodedCloud decoded = CloudDecoder(options()).decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->dropped_invalid, lost);
  ASSERT_EQ(decoded.scan->points.size(), rays.size() - lost);
  for (const ScanPoint& p : decoded.scan->points) {
    ASSERT_NEAR(p.offset_ns, kColumnStep * (p.x - 2.0), 1.0) << "its column's time";
    ASSERT_EQ(p.intensity, 7.0F);
  }
}

TEST(DriverCloud, TimesTooCoarseForASweepAreRefusedEvenWhenTheyDiffer) {
  constexpr TimeNs kJustBefore = 1600000000'950000000;  // the second changes within the sweep
  const std::vector<FixturePoint> seconds = points(1e-9 * kJustBefore, 1.0);
  const auto refusal = [&](std::uint8_t type) {
    return CloudDecoder(options()).decode(make_cloud(layout_of("hesai"), type, kJustBefore, seconds)).error;
  };
  EXPECT_NE(refusal(kUint64Code).find("uint64 counts in steps of 1 "), std::string::npos) << refusal(kUint64Code);
  EXPECT_NE(refusal(PointField::FLOAT32).find("float32 counts in steps of 190"), std::string::npos)
      << refusal(PointField::FLOAT32);
}

TEST(DriverCloud, OneAbsurdTimeDoesNotStretchTheScan) {
  for (const double absurd : {1e9, 1.5, 0.7, -0.4, std::nan("")}) {
    for (const bool first_scan : {true, false}) {
      SCOPED_TRACE(std::to_string(absurd) + (first_scan ? " in the first scan" : " in a later scan"));
      std::vector<FixturePoint> wild = points(0.0, 1.0);
      wild[100].raw_time = absurd;
      CloudDecoder decoder(options());
      if (!first_scan) {
        ASSERT_TRUE(decoder.decode(make_cloud(layout_of("velodyne"), 0, kStamp, points(0, 1))).scan);
      }
      const DecodedCloud decoded = decoder.decode(make_cloud(layout_of("velodyne"), 0, kStamp, wild));
      ASSERT_TRUE(decoded.scan) << decoded.error;
      EXPECT_EQ(decoded.scan->points.size(), std::size_t{kPoints - 1});
      EXPECT_EQ(decoded.scan->dropped_invalid, 1U);
      EXPECT_EQ(decoded.scan->first_offset_ns, 0);
      EXPECT_NEAR(decoded.scan->last_offset_ns, 1e9 * kSweep, 10);
      ASSERT_EQ(decoder.remarks().size(), 1U);
      EXPECT_EQ(decoder.remarks()[0].find("1 points were dropped because their time"), 0U) << decoder.remarks()[0];
    }
  }
}

TEST(DriverCloud, AScanWithManyAbsurdTimesIsRefused) {
  CloudDecoder decoder(options());
  ASSERT_TRUE(decoder.decode(make_cloud(layout_of("velodyne"), 0, kStamp, points(0, 1))).scan);
  std::vector<FixturePoint> wild = points(0.0, 1.0);
  for (std::size_t i = 0; i < wild.size(); i += 5) wild[i].raw_time = 1e9;
  const DecodedCloud decoded = decoder.decode(make_cloud(layout_of("velodyne"), 0, kStamp, wild));
  EXPECT_FALSE(decoded.scan);
  EXPECT_NE(decoded.error.find("'time': too many"), std::string::npos) << decoded.error;
  EXPECT_TRUE(decoder.decode(make_cloud(layout_of("velodyne"), 0, kStamp, points(0, 1))).scan)
      << "the next one is good";
}

TEST(DriverCloud, AnAbsurdFirstPointDoesNotMoveASweepThatIsPutToItsStamp) {
  std::vector<FixturePoint> wild = points(kOtherClock, 1.0);
  wild[0].raw_time = 1e12;
  CloudDecoder decoder(options(PointTime::kStart));
  const DecodedCloud decoded = decoder.decode(make_cloud(layout_of("hesai"), 0, kStamp, wild));
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->first_offset_ns, 0);
  EXPECT_EQ(decoded.scan->points.size(), std::size_t{kPoints - 1});
}

TEST(DriverCloud, LivoxTagsOfNoiseDropThePointUnlessTheyAreToBeKept) {
  std::vector<FixturePoint> tagged = points(1e-9 * kStamp, 1e9);
  const std::uint8_t tags[] = {0x00, 0x10, 0x20, 0x30, 0x0F};
  for (std::size_t i = 0; i < std::size(tags); ++i) tagged[i].tag = tags[i];
  LioConfig::Lidar lidar = options();
  CloudDecoder dropping(lidar);
  const sensor_msgs::PointCloud2 cloud = make_cloud(layout_of("livox"), 0, kStamp, tagged);
  const DecodedCloud decoded = dropping.decode(cloud);
  ASSERT_TRUE(decoded.scan) << decoded.error;
  EXPECT_EQ(decoded.scan->points.size(), std::size_t{kPoints - 2});
  EXPECT_EQ(decoded.scan->points[1].x, tagged[1].x);
  EXPECT_EQ(decoded.scan->points[2].x, tagged[4].x);
  ASSERT_EQ(dropping.remarks().size(), 1U);
  EXPECT_EQ(dropping.remarks()[0].find("2 points"), 0U) << dropping.remarks()[0];

  lidar.drop_tagged = false;
  EXPECT_EQ(CloudDecoder(lidar).decode(cloud).scan->points.size(), std::size_t{kPoints});
}

}  // namespace
}  // namespace allan_lio
