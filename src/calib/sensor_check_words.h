// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/calib/stamp_check.h"

namespace allan_lio {

/// Four significant digits, with a point whatever the locale.
std::string number(double value);
inline std::string count_of(std::size_t count) { return std::to_string(count); }
inline std::string seconds(double value) { return number(value) + " s"; }
inline std::string milliseconds(double value) { return number(1e3 * value) + " ms"; }
inline std::string hertz(double value) { return number(value) + " Hz"; }

/// "1600000000.000 to 1600000020.000 s".
std::string range(const StampReport& stamps);

/// "'a', 'b'".
template <class Words>
std::string list(const Words& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "'" : ", '") + word + "'";
  return text;
}

}  // namespace allan_lio
