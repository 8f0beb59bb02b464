// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/poll_manager.h>
#include <sys/types.h>

#include <atomic>
#include <string>

namespace allan_lio {

/// Whether threads that a thread starts have its priority.
enum class Heirs { kOrdinary, kTheSame };

/// Has `thread` (0: the calling one) run before all that has no real-time priority: SCHED_FIFO of sched(7) with
/// `priority` from 1 to 99; 0 is ordinary scheduling. Returns what hindered it, empty if nothing: the priority needs
/// root, CAP_SYS_NICE or an RLIMIT_RTPRIO.
std::string set_thread_priority(pid_t thread, int priority, Heirs heirs = Heirs::kOrdinary);

/// Gives roscpp's thread that reads and writes all sockets of this process a priority, as long as this lives. Call it
/// after ros::init(). What hinders it hinders set_thread_priority() as well and is not said again.
class PollThreadPriority {
 public:
  explicit PollThreadPriority(int priority);
  ~PollThreadPriority();
  PollThreadPriority(const PollThreadPriority&) = delete;
  PollThreadPriority& operator=(const PollThreadPriority&) = delete;

 private:
  void on_poll();

  const int priority_;
  std::atomic<pid_t> thread_{0};  ///< 0: not yet met
  bool hindered_ = false;         ///< of roscpp's thread alone
  boost::signals2::connection listener_;
};

}  // namespace allan_lio
