// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/imu_answers.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

/// At 200 Hz, states at 10 Hz.
ros::Time sample(int k) { return ros::Time(100, 0) + ros::Duration(0, 5000000) * k; }

/// 100 samples without those from `from` to `to`.
ImuAnswers::Missing without(int from, int to) {
  ImuAnswers answers;
  for (int k = 0; k < 100; ++k) {
    if (k % 20 == 0) answers.saw_state(sample(k));
    if (k < from || k > to) answers.saw_odometry(sample(k));
  }
  return answers.missing();
}

TEST(ImuAnswers, WithoutAGapNothingIsMissing) {
  EXPECT_EQ(without(1, 0).superseded, 0U);
  EXPECT_EQ(without(1, 0).lost, 0U);
}

TEST(ImuAnswers, SamplesUpToAStateAreSuperseded) {
  EXPECT_EQ(without(33, 40).superseded, 8U);
  EXPECT_EQ(without(33, 40).lost, 0U);
}

TEST(ImuAnswers, SamplesAwayFromAStateAreLost) {
  EXPECT_EQ(without(33, 41).lost, 9U);
  EXPECT_EQ(without(33, 41).superseded, 0U);
  EXPECT_EQ(without(50, 50).lost, 1U);
}

}  // namespace
}  // namespace allan_lio
