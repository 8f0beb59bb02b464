// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/thread_priority.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <thread>

namespace allan_lio {
namespace {

constexpr uid_t kNobody = 65534;

int policy() { return sched_getscheduler(0) & ~SCHED_RESET_ON_FORK; }

TEST(SpinBrake, ALoopThatSpinsIsToldAfterAFewTurnsAndAgain) {
  SpinBrake brake;
  std::int64_t now = 7'000'000'000;
  for (int series = 0; series < 3; ++series) {
    for (int turn = series == 0 ? 0 : 1; turn < SpinBrake::kTurns; ++turn) EXPECT_FALSE(brake.spins(now += 1000));
    EXPECT_TRUE(brake.spins(now += 1000));
  }
}

TEST(SpinBrake, ALoopThatWaitsForWorkIsNot) {
  SpinBrake brake;
  std::int64_t now = 0;
  const std::int64_t step = SpinBrake::kTooShort / SpinBrake::kTurns;
  for (int turn = 0; turn < 10 * SpinBrake::kTurns; ++turn) EXPECT_FALSE(brake.spins(now += step)) << turn;
}

TEST(ThreadPriority, IsRealTimeUntilItIsTakenBack) {
  std::thread([] {
    const std::string hindered = set_thread_priority(0, 3);
    if (!hindered.empty()) GTEST_SKIP() << hindered;
    sched_param parameters{};
    EXPECT_EQ(policy(), SCHED_FIFO);
    EXPECT_EQ(sched_getparam(0, &parameters), 0);
    EXPECT_EQ(parameters.sched_priority, 3);
    std::thread([] { EXPECT_EQ(policy(), SCHED_OTHER); }).join();
    EXPECT_EQ(set_thread_priority(0, 3, Heirs::kTheSame), "");
    std::thread([] { EXPECT_EQ(policy(), SCHED_FIFO); }).join();
    EXPECT_EQ(set_thread_priority(0, 0), "");
    EXPECT_EQ(policy(), SCHED_OTHER);
  }).join();
  EXPECT_EQ(policy(), SCHED_OTHER);
}

TEST(ThreadPriority, SaysWhatHinders) {
  EXPECT_EQ(set_thread_priority(0, 100), "Invalid argument");
  const pid_t child = fork();
  if (child == 0) {
    const rlimit none{0, 0};
    const bool may_not = setrlimit(RLIMIT_RTPRIO, &none) == 0 && (getuid() != 0 || setuid(kNobody) == 0);
    _exit(may_not && set_thread_priority(0, 1) == "Operation not permitted" ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace allan_lio
