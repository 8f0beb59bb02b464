// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/sequence_watch.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

constexpr std::uint32_t kMany = 10 * SequenceWatch::kSettled;

/// So many numbers from `begin` on, each `step` more than the one before.
void feed(SequenceWatch& watch, std::uint32_t begin, std::uint32_t count, std::uint32_t step = 1) {
  for (std::uint32_t i = 0; i < count; ++i) watch.add(begin + i * step);
}

TEST(SequenceWatch, WhatIsSkippedIsLostOnceTheNumbersHaveGoneOn) {
  SequenceWatch watch;
  feed(watch, 1000, kMany);
  EXPECT_EQ(watch.lost(), 0U) << "what was sent before the first message is not";
  feed(watch, 1000 + kMany + 7, SequenceWatch::kSettled);
  EXPECT_EQ(watch.lost(), 0U) << "not told yet";
  feed(watch, 1000 + kMany + 7 + SequenceWatch::kSettled, 1);
  EXPECT_EQ(watch.lost(), 7U);
  feed(watch, 1000 + kMany + 7 + SequenceWatch::kSettled + 1, kMany);
  EXPECT_EQ(watch.lost(), 7U);
}

TEST(SequenceWatch, AQueueThatOverflowsAllTheTimeIsCounted) {
  SequenceWatch watch;
  feed(watch, 0, SequenceWatch::kSettled + 1);
  feed(watch, SequenceWatch::kSettled + 3, 2 * SequenceWatch::kSettled, 3);
  EXPECT_EQ(watch.lost(), 2U * SequenceWatch::kSettled);
}

TEST(SequenceWatch, ADriverThatLeavesTheNumberLosesNothing) {
  for (const std::uint32_t number : {0U, 5U}) {
    SequenceWatch watch;
    feed(watch, number, kMany, 0);
    EXPECT_EQ(watch.lost(), 0U);
  }
}

TEST(SequenceWatch, APublisherThatStartsAnewLosesNothingAndIsWatchedFromThenOn) {
  SequenceWatch watch;
  feed(watch, 5000, kMany);
  feed(watch, 0, kMany);
  EXPECT_EQ(watch.lost(), 0U);
  feed(watch, kMany + 2, kMany);
  EXPECT_EQ(watch.lost(), 2U);
}

TEST(SequenceWatch, TwoPublishersOnOneTopicAreNotCounted) {
  for (const std::uint32_t second : {3U, 90000U}) {
    SequenceWatch watch;
    feed(watch, 1000, kMany);  // the second one comes later
    for (std::uint32_t i = 0; i < kMany; ++i) {
      watch.add(second + i);
      watch.add(1000 + kMany + i);
      if (i % 3 == 0) watch.add(1000 + kMany + i);  // not in step
    }
    EXPECT_EQ(watch.lost(), 0U) << second;
  }
}

TEST(SequenceWatch, AThrottleIsNoLoss) {
  SequenceWatch every_second, uneven;
  feed(every_second, 0, kMany, 2);
  EXPECT_EQ(every_second.lost(), 0U);
  for (std::uint32_t i = 0; i < kMany; ++i) uneven.add(i + i / 4);  // one in five is left out
  EXPECT_EQ(uneven.lost(), 0U);
}

TEST(SequenceWatch, TheNumbersMayRunOver) {
  SequenceWatch watch;
  feed(watch, 0U - kMany, 2 * kMany);
  EXPECT_EQ(watch.lost(), 0U);
  feed(watch, kMany + 4, kMany);
  EXPECT_EQ(watch.lost(), 4U);
}

}  // namespace
}  // namespace allan_lio
