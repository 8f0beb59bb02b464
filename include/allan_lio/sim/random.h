// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "allan_lio/math/random_bits.h"

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

/// Independent standard normal values: a counter through SplitMix64, two words to two values by Box and Muller.
class NormalStream {
 public:
  /// Streams of one seed are independent of each other.
  NormalStream(std::uint64_t seed, std::uint64_t stream) : state_(hash_bits(hash_bits(seed) ^ hash_bits(~stream))) {}

  double next() {
    has_second_ = !has_second_;
    if (!has_second_) return second_;
    constexpr double kTwoPi = 6.28318530717958647692;
    constexpr double kInverse53 = 1.0 / 9007199254740992.0;  // 2^-53
    const double u = (static_cast<double>(next_bits() >> 11) + 0.5) * kInverse53;
    const double angle = kTwoPi * kInverse53 * static_cast<double>(next_bits() >> 11);
    const double radius = std::sqrt(-2.0 * std::log(u));
    second_ = radius * std::sin(angle);
    return radius * std::cos(angle);
  }

 private:
  std::uint64_t next_bits() {
    constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ull;
    return hash_bits(state_ += kGolden);
  }

  std::uint64_t state_;
  double second_ = 0.0;
  bool has_second_ = false;
};

}  // namespace allan_lio
