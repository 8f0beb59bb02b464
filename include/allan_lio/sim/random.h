// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

namespace allan_lio {

/// A standard normal value from two uniform 64-bit words (Box and Muller 1958). The standard library's
/// distribution is not used because its values differ between implementations.
inline double normal_from_bits(std::uint64_t a, std::uint64_t b) {
  constexpr double kTwoPi = 6.28318530717958647692;
  constexpr double kInverse53 = 1.0 / 9007199254740992.0;              // 2^-53
  const double u = (static_cast<double>(a >> 11) + 0.5) * kInverse53;  // never 0
  const double v = static_cast<double>(b >> 11) * kInverse53;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(kTwoPi * v);
}

/// Scrambles a counter: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
inline std::uint64_t hash_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

}  // namespace allan_lio
