// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/stop_signals.h"

namespace allan_lio {

StopSignals::StopSignals() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  watcher_ = std::thread([this] {
    const timespec latency{0, 100000000};
    while (!over_ && !came_) came_ = sigtimedwait(&signals_, nullptr, &latency) > 0;
  });
}

StopSignals::~StopSignals() {
  over_ = true;
  watcher_.join();
}

}  // namespace allan_lio
