// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/shut_down_on_sigterm.h"

#include <ros/init.h>
#include <signal.h>

namespace allan_lio {
namespace {

/// Only sets a flag that roscpp looks at, as its own handler of SIGINT does.
void on_sigterm(int) { ros::requestShutdown(); }

}  // namespace

void shut_down_on_sigterm() {
  struct sigaction before {};
  if (sigaction(SIGTERM, nullptr, &before) != 0 || before.sa_handler != SIG_DFL) return;
  struct sigaction ours {};
  ours.sa_handler = on_sigterm;
  ours.sa_flags = SA_RESTART;
  sigemptyset(&ours.sa_mask);
  sigaction(SIGTERM, &ours, nullptr);
}

}  // namespace allan_lio
