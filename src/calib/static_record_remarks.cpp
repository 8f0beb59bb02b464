// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <locale>
#include <sstream>

#include "allan_lio/calib/static_record.h"

namespace allan_lio {
namespace {

constexpr double kTellJitter = 0.1;  // of the period, from which on it is said

std::string text(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(4);
  out << value;
  return out.str();
}

std::string plural(std::int64_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

}  // namespace

std::vector<std::string> StaticRecord::remarks() const {
  std::vector<std::string> remarks;
  const RecordFaults& f = faults_;
  if (jitter() > kTellJitter * tau0())
    remarks.push_back("the stamps scatter by " + text(1e3 * jitter()) + " ms rms about an even grid of " +
                      text(1e3 * tau0()) + " ms; the samples are taken as equally spaced");
  if (f.not_finite > 0) remarks.push_back(plural(f.not_finite, "sample") + " dropped for NaN or inf");
  if (f.backward > 0)
    remarks.push_back(plural(f.backward, "sample") + " dropped for a stamp not later than the one before");
  if (f.clock_set_back > 0)
    remarks.push_back("the clock was set back " + plural(f.clock_set_back, "time") + ": a new piece begins there");
  if (f.bridged_gaps > 0)
    remarks.push_back(plural(f.bridged_samples, "sample") + " missing in " + plural(f.bridged_gaps, "short gap") +
                      ", bridged by straight lines");
  if (f.long_gaps > 0)
    remarks.push_back(plural(f.long_gaps, "gap") + " of more than " + std::to_string(kLongestBridge) +
                      " samples, the longest " + text(f.longest_gap) + " s: a new piece begins after each");
  if (stride_ > 1)
    remarks.push_back("long record: one integrated value is kept for every " + std::to_string(stride_) +
                      " samples, and short averaging times rest on the part that had been read before");
  return remarks;
}

}  // namespace allan_lio
