// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include "allan_lio/calib/trial_pool.h"

namespace allan_lio {

/// Tells on the standard error how far a tuning is: a bar with the time left on a terminal, elsewhere a line now and
/// then, so that short work says nothing.
class TuningProgress {
 public:
  /// `trials_a_setting`: bags times runs.
  explicit TuningProgress(std::size_t trials_a_setting);
  ~TuningProgress() { clear(); }
  TuningProgress(const TuningProgress&) = delete;
  TuningProgress& operator=(const TuningProgress&) = delete;

  /// Something else than trials is done to this part.
  void part(const std::string& what, double part);
  void note(const std::string& text);

  /// From here on trials count for this phase, which takes about so many settings.
  void phase(const std::string& name, std::size_t settings);
  void trial(const FinishedTrial& finished);

  /// Takes the bar away.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  void show(const std::string& text, double part, bool at_once);

  const bool terminal_;
  const std::size_t trials_a_setting_;
  std::string phase_;
  std::size_t expected_ = 0, done_ = 0, run_ = 0;  ///< trials of the phase; `run_` without those from the store
  Clock::time_point begin_, shown_;
  bool bar_ = false;
};

}  // namespace allan_lio
