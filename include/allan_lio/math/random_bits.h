// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace allan_lio {

/// Scrambles a counter: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
inline std::uint64_t hash_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A value from [0, 1).
inline double uniform_from_bits(std::uint64_t a) { return static_cast<double>(a >> 11) / 9007199254740992.0; }

}  // namespace allan_lio
