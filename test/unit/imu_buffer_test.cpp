// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/imu_buffer.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr TimeNs kStep = 10'000'000;  // 10 ms
constexpr double kRounding = 1e-12;

/// Readings that grow linearly with time.
ImuBuffer ramp(int count) {
  ImuBuffer buffer;
  for (int i = 0; i < count; ++i)
    buffer.push({i * kStep, Eigen::Vector3d::Constant(i), Eigen::Vector3d::Constant(10.0 * i)});
  return buffer;
}

TEST(ImuBuffer, RefusesStampsThatAreNotLater) {
  ImuBuffer buffer = ramp(3);
  EXPECT_FALSE(buffer.push({2 * kStep, {}, {}}));
  EXPECT_FALSE(buffer.push({kStep, {}, {}}));
  EXPECT_TRUE(buffer.push({2 * kStep + 1, {}, {}}));
  EXPECT_EQ(buffer.size(), 4u);
}

TEST(ImuBuffer, InterpolatesLinearlyAndHoldsTheEnds) {
  const ImuBuffer buffer = ramp(5);
  EXPECT_NEAR(buffer.at(kStep * 3 / 2).gyro.x(), 1.5, kRounding);
  EXPECT_NEAR(buffer.at(kStep * 3 / 2).accel.y(), 15.0, kRounding);
  EXPECT_NEAR(buffer.at(3 * kStep).gyro.x(), 3.0, kRounding);
  EXPECT_EQ(buffer.at(-kStep).gyro.x(), 0.0);
  EXPECT_EQ(buffer.at(9 * kStep).gyro.x(), 4.0);
}

TEST(ImuBuffer, SplitsAnIntervalAtItsEndsAndKeepsTheSamplesInside) {
  const ImuBuffer buffer = ramp(6);
  const auto samples = buffer.between(kStep / 2, kStep * 7 / 2);
  ASSERT_EQ(samples.size(), 5u);
  EXPECT_EQ(samples.front().stamp, kStep / 2);
  EXPECT_NEAR(samples.front().gyro.x(), 0.5, kRounding);
  EXPECT_EQ(samples[1].stamp, kStep);
  EXPECT_EQ(samples.back().stamp, kStep * 7 / 2);
  EXPECT_NEAR(samples.back().gyro.x(), 3.5, kRounding);
}

TEST(ImuBuffer, DoesNotDoubleASampleThatLiesOnAnEnd) {
  const auto samples = ramp(6).between(kStep, 3 * kStep);
  ASSERT_EQ(samples.size(), 3u);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_LT(samples[i - 1].stamp, samples[i].stamp);
}

TEST(ImuBuffer, AGapIsSeenOnceByTheIntervalInWhichItEnds) {
  ImuBuffer buffer = ramp(3);
  buffer.push({100 * kStep, {}, {}});
  EXPECT_NEAR(buffer.longest_gap(0, 50 * kStep), 0.01, kRounding);
  EXPECT_NEAR(buffer.longest_gap(50 * kStep, 100 * kStep), 0.98, kRounding);
  EXPECT_EQ(buffer.longest_gap(100 * kStep, 150 * kStep), 0.0);
}

TEST(ImuBuffer, ASilenceIsMeasuredInsideTheTimeAskedForAndKnowsItsEnd) {
  ImuBuffer buffer = ramp(3);
  buffer.push({100 * kStep, {}, {}});
  buffer.push({101 * kStep, {}, {}});
  EXPECT_NEAR(buffer.longest_silence(0, 101 * kStep).seconds, 0.98, kRounding);
  EXPECT_NEAR(buffer.longest_silence(0, 50 * kStep).seconds, 0.48, kRounding);
  EXPECT_NEAR(buffer.longest_silence(30 * kStep, 50 * kStep).seconds, 0.20, kRounding);
  EXPECT_EQ(buffer.longest_silence(30 * kStep, 50 * kStep).begin, 30 * kStep);
  EXPECT_EQ(buffer.longest_silence(30 * kStep, 50 * kStep).end, 100 * kStep);
  EXPECT_NEAR(buffer.longest_silence(100 * kStep, 200 * kStep).seconds, 0.01, kRounding);
  EXPECT_EQ(buffer.longest_silence(101 * kStep, 200 * kStep).seconds, 0.0);
}

TEST(ImuBuffer, TheSpacingIsThatOfTheSamplesAround) {
  ImuBuffer buffer = ramp(3);
  buffer.push({100 * kStep, {}, {}});
  EXPECT_NEAR(buffer.spacing_at(kStep / 2), 0.01, kRounding);
  EXPECT_NEAR(buffer.spacing_at(50 * kStep), 0.98, kRounding);
  EXPECT_EQ(buffer.spacing_at(101 * kStep), 0.0);
}

TEST(ImuBuffer, KeepsTheSampleBeforeTheTimeItDiscardsTo) {
  ImuBuffer buffer = ramp(6);
  buffer.discard_before(kStep * 5 / 2);
  EXPECT_EQ(buffer.oldest(), 2 * kStep);
  EXPECT_NEAR(buffer.at(kStep * 5 / 2).gyro.x(), 2.5, kRounding);
}

}  // namespace
}  // namespace allan_lio
