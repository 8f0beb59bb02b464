// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/tuning_progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace allan_lio {
namespace {

constexpr double kBarEvery = 0.2, kLineEvery = 10.0;  // [s]
constexpr int kBarWidth = 30, kLineWidth = 110;

std::string time_text(double seconds) {
  char text[40];
  if (seconds < 90.0)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60.0);
  return text;
}

}  // namespace

TuningProgress::TuningProgress(std::size_t trials_a_setting)
    : terminal_(isatty(STDERR_FILENO) != 0),
      trials_a_setting_(trials_a_setting),
      begin_(Clock::now()),
      shown_(begin_) {}

void TuningProgress::part(const std::string& what, double part) { show(what, part, false); }

void TuningProgress::note(const std::string& text) {
  clear();
  std::fprintf(stderr, "%s\n", text.c_str());
}

void TuningProgress::phase(const std::string& name, std::size_t settings) {
  phase_ = name;
  expected_ = settings * trials_a_setting_;
  done_ = run_ = 0;
  begin_ = Clock::now();
}

void TuningProgress::trial(const FinishedTrial& finished) {
  ++done_;
  if (!finished.stored) ++run_;
  expected_ = std::max(expected_, done_ + finished.asked - finished.done);
  const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
  std::string text = phase_ + ": " + std::to_string(done_) + " of about " + std::to_string(expected_) + " runs";
  if (run_ > 0 && expected_ > done_)
    text += ", " + time_text(elapsed / static_cast<double>(run_) * static_cast<double>(expected_ - done_)) + " left";
  show(text, static_cast<double>(done_) / static_cast<double>(expected_), done_ == expected_);
}

void TuningProgress::show(const std::string& text, double part, bool at_once) {
  const Clock::time_point now = Clock::now();
  const double since = std::chrono::duration<double>(now - shown_).count();
  if (since < (terminal_ ? kBarEvery : kLineEvery) && !(terminal_ && at_once)) return;
  shown_ = now;
  if (!terminal_) {
    std::fprintf(stderr, "%s\n", text.c_str());
    return;
  }
  const std::string done(static_cast<std::size_t>(kBarWidth * std::min(1.0, std::max(0.0, part))), '#');
  std::fprintf(stderr, "\r%-*.*s\r[%-*s] %s", kLineWidth, kLineWidth, "", kBarWidth, done.c_str(), text.c_str());
  std::fflush(stderr);
  bar_ = true;
}

void TuningProgress::clear() {
  if (bar_) std::fprintf(stderr, "\r%*s\r", kLineWidth, "");
  bar_ = false;
}

}  // namespace allan_lio
