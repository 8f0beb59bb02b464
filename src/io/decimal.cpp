// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/decimal.h"

#include <cmath>
#include <limits>

namespace allan_lio {
namespace {

constexpr int kMaxDigits = 19;  // of any mantissa below 2^64
constexpr int kMaxExponent = 100000;

// All of them exact.
constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
constexpr int kLargestPower = 22;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads an exponent behind a number if there is one; null if it has no digits.
const char* scan_exponent(const char* at, const char* end, int* exponent) {
  if (at == end || (*at != 'e' && *at != 'E')) return at;
  ++at;
  const bool negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  if (at == end || !is_digit(*at)) return nullptr;
  int value = 0;
  for (; at != end && is_digit(*at); ++at)
    if (value < kMaxExponent) value = 10 * value + (*at - '0');
  *exponent += negative ? -value : value;
  return at;
}

}  // namespace

const char* scan_decimal(const char* begin, const char* end, Decimal* decimal) {
  const char* at = begin;
  decimal->negative = at != end && *at == '-';
  if (at != end && (*at == '-' || *at == '+')) ++at;
  std::uint64_t mantissa = 0;
  int digits = 0, exponent = 0;
  bool seen = false, whole = true;
  // Leading zeros don't count; digits beyond the 19th only say how large the number is.
  const auto take = [&](char c, int place) {
    seen = true;
    if (digits < kMaxDigits) {
      mantissa = 10 * mantissa + static_cast<std::uint64_t>(c - '0');
      digits += mantissa != 0;
      exponent -= place;
    } else {
      whole = whole && c == '0';
      exponent += 1 - place;
    }
  };
  for (; at != end && is_digit(*at); ++at) take(*at, 0);
  if (at != end && *at == '.')
    for (++at; at != end && is_digit(*at); ++at) take(*at, 1);
  if (!seen) return nullptr;
  decimal->mantissa = mantissa;
  decimal->exponent = exponent;
  decimal->whole = whole;
  return scan_exponent(at, end, &decimal->exponent);
}

bool to_double(const Decimal& decimal, double* value) {
  const int power = decimal.exponent < 0 ? -decimal.exponent : decimal.exponent;
  if (!decimal.whole || power > kLargestPower) return false;
  const double scale = kPowersOfTen[power];
  const bool divide = decimal.exponent < 0;
  // The mantissa as two doubles. If the second is zero, one operation on exact numbers rounds rightly.
  const auto high = static_cast<double>(decimal.mantissa);
  double result = divide ? high / scale : high * scale;
  constexpr std::uint64_t kExact = 1ULL << 53U;
  if (decimal.mantissa > kExact) {
    // 2^64 is what the largest mantissas round to; it does not fit an integer.
    constexpr double kTwo64 = 18446744073709551616.0;
    const double low =
        high == kTwo64
            ? -static_cast<double>(0 - decimal.mantissa)
            : static_cast<double>(static_cast<std::int64_t>(decimal.mantissa - static_cast<std::uint64_t>(high)));
    const double remainder = divide ? std::fma(-result, scale, high) : std::fma(high, scale, -result);
    const double rest = divide ? (remainder + low) / scale : remainder + low * scale;
    const double doubt = std::abs(rest) * (4.0 * std::numeric_limits<double>::epsilon());
    const double least = result + (rest - doubt), most = result + (rest + doubt);
    if (least != most) return false;
    result = least;
  }
  *value = decimal.negative ? -result : result;
  return true;
}

bool to_time(const Decimal& decimal, int shift, TimeNs* time) {
  std::uint64_t value = decimal.mantissa;
  int exponent = decimal.exponent + shift;
  constexpr auto kLimit = static_cast<std::uint64_t>(std::numeric_limits<TimeNs>::max());
  if (value == 0) exponent = 0;
  for (; exponent > 0; --exponent) {
    if (value > kLimit / 10) return false;
    value *= 10;
  }
  bool round_up = false;
  for (; exponent < 0; ++exponent) {
    round_up = value % 10 >= 5;
    value /= 10;
    if (value == 0 && exponent < -1) {
      round_up = false;
      break;
    }
  }
  value += round_up;
  if (value > kLimit) return false;
  *time = decimal.negative ? -static_cast<TimeNs>(value) : static_cast<TimeNs>(value);
  return true;
}

}  // namespace allan_lio
