// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/poll_manager.h>
#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <utility>

namespace allan_lio {

/// Whether threads that a thread starts have its priority.
enum class Heirs { kOrdinary, kTheSame };

/// Has `thread` (0: the calling one) run before all that has no real-time priority: SCHED_FIFO of sched(7) with
/// `priority` from 1 to 99; 0 is ordinary scheduling. Returns what hindered it, empty if nothing: the priority needs
/// root, CAP_SYS_NICE or an RLIMIT_RTPRIO.
std::string set_thread_priority(pid_t thread, int priority, Heirs heirs = Heirs::kOrdinary);

/// Tells a loop that spins from one that works: kTurns turns in less than kTooShort are no work.
class SpinBrake {
 public:
  static constexpr int kTurns = 50;
  static constexpr std::int64_t kTooShort = 1'000'000;  ///< [ns]

  /// `now`: at each turn, of a monotonic clock [ns]. True at the last of such a series; the next one begins there.
  bool spins(std::int64_t now) {
    if (turns_ == 0) begin_ = now;
    if (turns_++ < kTurns) return false;
    turns_ = 1;
    return now - std::exchange(begin_, now) < kTooShort;
  }

 private:
  int turns_ = 0;
  std::int64_t begin_ = 0;  ///< of the series [ns]
};

/// Gives roscpp's thread that reads and writes all sockets of this process a priority, as long as this lives. Call it
/// after ros::init(). What hinders it hinders set_thread_priority() as well and is not said again.
///
/// That thread may spin: it asks for sockets that can be written to, and does nothing about one whose writer has not
/// yet noted that it waits for that (TransportTCP::enableWrite). If the writer's thread has an ordinary priority and
/// no other core is free, it then never comes to note it. So the thread sleeps for kBreath where it spins.
class PollThreadPriority {
 public:
  explicit PollThreadPriority(int priority);
  ~PollThreadPriority();
  PollThreadPriority(const PollThreadPriority&) = delete;
  PollThreadPriority& operator=(const PollThreadPriority&) = delete;

 private:
  static constexpr std::int64_t kBreath = 100'000;  ///< [ns]

  void on_poll();

  const int priority_;
  std::atomic<pid_t> thread_{0};  ///< 0: not yet met
  bool hindered_ = false;         ///< of roscpp's thread alone, as the next
  SpinBrake brake_;
  boost::signals2::connection listener_;
};

}  // namespace allan_lio
