// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/init.h>

#include <stdexcept>

namespace allan_lio {

/// A node is told to stop while it starts: no error.
class StoppedAtStart : public std::runtime_error {
 public:
  StoppedAtStart() : std::runtime_error("stopped while it started") {}
};

/// Throws StoppedAtStart if ROS is being shut down. Call it between advertising and a first message: what is advertised
/// after that is no topic, and roscpp traps (SIGTRAP) who publishes on it. What was advertised before takes messages.
inline void require_running() {
  if (ros::isShuttingDown()) throw StoppedAtStart();
}

}  // namespace allan_lio
