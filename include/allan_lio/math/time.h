// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace allan_lio {

/// Absolute time [ns] since the clock's epoch. A double second is only ever a difference.
using TimeNs = std::int64_t;

constexpr TimeNs kNsPerSecond = 1'000'000'000;

/// `to - from` [s].
inline double seconds_between(TimeNs from, TimeNs to) { return 1e-9 * static_cast<double>(to - from); }

/// The difference `seconds` [s] as nanoseconds, rounded to the nearest.
inline TimeNs to_ns(double seconds) { return static_cast<TimeNs>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5)); }

}  // namespace allan_lio
