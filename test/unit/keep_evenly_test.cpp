// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/keep_evenly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

#include "allocation_count.h"

namespace allan_lio {
namespace {

constexpr int kBeams = 16, kColumns = 1000;
constexpr std::uint32_t kPoints = kBeams * kColumns;
constexpr std::int32_t kColumnTime = 100'000;  // [ns]

int beam_of(const ScanPoint& p) { return static_cast<int>(p.intensity); }
int column_of(const ScanPoint& p) { return p.offset_ns / kColumnTime; }

/// A sweep whose beams fire together, column by column.
std::vector<ScanPoint> by_columns() {
  std::vector<ScanPoint> points;
  for (int column = 0; column < kColumns; ++column)
    for (int beam = 0; beam < kBeams; ++beam)
      points.push_back({1, 2, 3, static_cast<float>(beam), column * kColumnTime});
  return points;
}

/// The same sweep as an organised cloud has it: beam by beam.
std::vector<ScanPoint> by_beams() {
  std::vector<ScanPoint> points = by_columns();
  std::stable_sort(points.begin(), points.end(),
                   [](const ScanPoint& a, const ScanPoint& b) { return a.intensity < b.intensity; });
  return points;
}

std::vector<std::uint32_t> all_of(const std::vector<ScanPoint>& points) {
  std::vector<std::uint32_t> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0U);
  return indices;
}

TEST(KeepEvenly, LeavesSoManyInTheirOrderOneOfEachPartOfTheSweep) {
  for (const std::vector<ScanPoint>& points : {by_columns(), by_beams()}) {
    for (const std::size_t most : {1U, 7U, 250U, 999U, 1000U}) {
      std::vector<std::uint32_t> kept = all_of(points);
      keep_evenly(points, most, kept);
      ASSERT_EQ(kept.size(), most);
      EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
      EXPECT_EQ(std::adjacent_find(kept.begin(), kept.end()), kept.end()) << "a point twice";
      std::vector<int> columns;
      for (const std::uint32_t index : kept) columns.push_back(column_of(points[index]));
      std::sort(columns.begin(), columns.end());
      const double width = static_cast<double>(kColumns) / static_cast<double>(most);
      for (std::size_t part = 0; part < most; ++part) {
        EXPECT_GE(columns[part], std::floor(width * static_cast<double>(part)) - 1) << most;
        EXPECT_LE(columns[part], std::ceil(width * static_cast<double>(part + 1))) << most;
      }
    }
  }
}

TEST(KeepEvenly, NoBeamIsPreferred) {
  // One of 16 points of each column: in even steps all would be of one beam.
  const std::vector<ScanPoint> points = by_columns();
  std::vector<std::uint32_t> kept = all_of(points);
  keep_evenly(points, kColumns, kept);
  std::vector<int> of_beam(kBeams, 0);
  for (const std::uint32_t index : kept) ++of_beam[static_cast<std::size_t>(beam_of(points[index]))];
  // Binomial: 62.5 +- 4 sigma of 7.7.
  for (const int count : of_beam) EXPECT_NEAR(count, kColumns / kBeams, 31);
}

TEST(KeepEvenly, TheSamePointsOfTheSweepWhateverTheirOrderInTheMessage) {
  const std::vector<ScanPoint> columns = by_columns(), beams = by_beams();
  std::vector<std::uint32_t> a = all_of(columns), b = all_of(beams);
  keep_evenly(columns, 300, a);
  keep_evenly(beams, 300, b);
  std::set<std::pair<int, int>> of_a, of_b;
  for (const std::uint32_t index : a) of_a.insert({column_of(columns[index]), beam_of(columns[index])});
  for (const std::uint32_t index : b) of_b.insert({column_of(beams[index]), beam_of(beams[index])});
  EXPECT_EQ(of_a, of_b);
}

TEST(KeepEvenly, FewEnoughStayAsTheyAreAndNothingIsAllocated) {
  const std::vector<ScanPoint> points = by_beams();
  std::vector<std::uint32_t> kept{5, 7, 15000};
  keep_evenly(points, 3, kept);
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{5, 7, 15000}));
  kept = all_of(points);
  ASSERT_EQ(kept.size(), kPoints);
  const std::optional<std::size_t> before = bytes_allocated();
  keep_evenly(points, 2000, kept);
  EXPECT_EQ(bytes_allocated(), before);
}

}  // namespace
}  // namespace allan_lio
