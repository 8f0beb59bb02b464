// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "allan_lio/math/time.h"

namespace allan_lio {

/// A decimal number as it is written: (-1)^negative * mantissa * 10^exponent.
struct Decimal {
  std::uint64_t mantissa = 0;  ///< the first 19 digits that count
  int exponent = 0;
  bool negative = false;
  bool whole = true;  ///< false: digits beyond the 19th were left out
};

/// Reads a number such as "-1.5e-3" from the beginning of [begin, end) and returns where it ends; null if there is
/// none. No locale is asked.
const char* scan_decimal(const char* begin, const char* end, Decimal* decimal);

/// The nearest double, for every number that 19 digits and exponents from -22 to 22 can write but for a few close to
/// the middle of two doubles. False for the others.
bool to_double(const Decimal& decimal, double* value);

/// decimal * 10^shift rounded to an integer, away from zero at the middle; shift 9 takes seconds to nanoseconds.
/// False if it does not fit.
bool to_time(const Decimal& decimal, int shift, TimeNs* time);

}  // namespace allan_lio
