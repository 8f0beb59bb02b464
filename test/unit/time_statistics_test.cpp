// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/time_statistics.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

/// `count` times that run evenly through 0.001 to 1 s, out of order: 7919 and 1000 have no common factor.
TimeStatistics even_times(std::uint64_t count) {
  TimeStatistics times;
  for (std::uint64_t k = 0; k < count; ++k) times.add(1e-3 * static_cast<double>(1 + k * 7919 % 1000));
  return times;
}

TEST(TimeStatistics, WithoutTimesEverythingIsZero) {
  const TimeStatistics none;
  EXPECT_EQ(none.count(), 0U);
  EXPECT_EQ(none.mean() + none.largest() + none.percentile(0.95), 0.0);
}

TEST(TimeStatistics, AShortRunIsExact) {
  const TimeStatistics times = even_times(1000);
  EXPECT_EQ(times.count(), 1000U);
  EXPECT_NEAR(times.mean(), 0.5005, 1e-12);
  EXPECT_DOUBLE_EQ(times.percentile(0.5), 0.5);
  EXPECT_DOUBLE_EQ(times.percentile(0.95), 0.95);
  EXPECT_DOUBLE_EQ(times.largest(), 1.0);
}

TEST(TimeStatistics, ALongRunKeepsMeanAndLargestAndNearlyThePercentiles) {
  TimeStatistics times = even_times(10 * TimeStatistics::kKept + 1);
  times.add(7.0);  // where no kept one falls
  EXPECT_EQ(times.count(), 10 * TimeStatistics::kKept + 2);
  EXPECT_EQ(times.largest(), 7.0);
  EXPECT_NEAR(times.mean(), 0.5005, 1e-3);
  EXPECT_NEAR(times.percentile(0.5), 0.5, 0.02);
  EXPECT_NEAR(times.percentile(0.95), 0.95, 0.02);
}

}  // namespace
}  // namespace allan_lio
