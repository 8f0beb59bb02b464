// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/thread_priority.h"

#include <sched.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace allan_lio {

std::string set_thread_priority(pid_t thread, int priority, Heirs heirs) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int real_time = heirs == Heirs::kTheSame ? SCHED_FIFO : SCHED_FIFO | SCHED_RESET_ON_FORK;
  if (sched_setscheduler(thread, priority > 0 ? real_time : SCHED_OTHER, &parameters) == 0) return "";
  return std::generic_category().message(errno);
}

PollThreadPriority::PollThreadPriority(int priority) : priority_(priority) {
  if (priority_ > 0) listener_ = ros::PollManager::instance()->addPollThreadListener([this] { on_poll(); });
}

PollThreadPriority::~PollThreadPriority() {
  if (priority_ == 0) return;
  ros::PollManager::instance()->removePollThreadListener(listener_);  // waits for a call that is under way
  if (thread_ != 0) set_thread_priority(thread_, 0);
}

void PollThreadPriority::on_poll() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (brake_.spins(std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec)) {
    const timespec breath{0, kBreath};
    nanosleep(&breath, nullptr);
  }
  // Again where another one of this process has ended and taken it back.
  if (hindered_ || (sched_getscheduler(0) & ~SCHED_RESET_ON_FORK) == SCHED_FIFO) return;
  thread_ = static_cast<pid_t>(syscall(SYS_gettid));
  hindered_ = !set_thread_priority(thread_, priority_).empty();
}

}  // namespace allan_lio
