// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/stop_signals.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>

namespace allan_lio {
namespace {

bool comes(const std::atomic<bool>& flag) {
  for (int i = 0; i < 500 && !flag; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return flag;
}

// Each in a process of its own: what is blocked here would be blocked in all later tests.
using StopSignalsDeathTest = ::testing::TestWithParam<int>;

TEST_P(StopSignalsDeathTest, ASignalRaisesTheFlagAndNothingElse) {
  const auto receive = [signal = GetParam()] {
    const StopSignals stop;
    if (stop.flag()) std::exit(1);
    kill(getpid(), signal);
    std::exit(comes(stop.flag()) ? 0 : 2);
  };
  EXPECT_EXIT(receive(), ::testing::ExitedWithCode(0), "");
}

// Found by a run that was killed between its last file and its exit: its summary said complete, its status 143.
TEST_P(StopSignalsDeathTest, ASignalAfterTheEndDoesNotChangeTheStatus) {
  const auto end = [signal = GetParam()] {
    { const StopSignals stop; }
    kill(getpid(), signal);
    std::exit(0);
  };
  EXPECT_EXIT(end(), ::testing::ExitedWithCode(0), "");
}

INSTANTIATE_TEST_SUITE_P(Signals, StopSignalsDeathTest, ::testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace allan_lio
