// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <signal.h>

#include <atomic>
#include <thread>

namespace allan_lio {

/// SIGINT and SIGTERM as a flag. Make it before any other thread: they are blocked in all that are started later.
/// They stay blocked after it: a program that has come to its end says how it ended, whatever comes while it goes.
class StopSignals {
 public:
  StopSignals();
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  const std::atomic<bool>& flag() const { return came_; }

 private:
  std::atomic<bool> came_{false}, over_{false};
  sigset_t signals_{};
  std::thread watcher_;
};

}  // namespace allan_lio
