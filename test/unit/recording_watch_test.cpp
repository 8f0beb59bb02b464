// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/recording_watch.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1'700'000'000 * kNsPerSecond, kStep = 5'000'000, kHour = 3600 * kNsPerSecond;

/// Feeds `count` samples from `from` on; how many of them begin a recording anew.
int feed(RecordingWatch& watch, TimeNs from, int count) {
  int anew = 0;
  for (int i = 0; i < count; ++i) anew += watch.begins_anew(from + i * kStep) ? 1 : 0;
  return anew;
}

TEST(RecordingWatch, OneStampFromTheFutureChangesNothing) {
  RecordingWatch watch;
  EXPECT_EQ(feed(watch, kStart, 100), 0);
  EXPECT_FALSE(watch.begins_anew(kStart + kHour));
  EXPECT_EQ(feed(watch, kStart + 100 * kStep, 100), 0);
  EXPECT_EQ(watch.newest(), kStart + 199 * kStep);
}

TEST(RecordingWatch, AClockSetForwardIsFollowed) {
  RecordingWatch watch;
  feed(watch, kStart, 100);
  EXPECT_EQ(feed(watch, kStart + kHour, 100), 0);
  EXPECT_EQ(watch.newest(), kStart + kHour + 99 * kStep);
}

TEST(RecordingWatch, StampsThatStayBackBeginANewRecording) {
  RecordingWatch watch;
  feed(watch, kStart + kHour, 100);
  EXPECT_EQ(feed(watch, kStart, RecordingWatch::kSamplesBackInTime), 1);
}

}  // namespace
}  // namespace allan_lio
