// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "allan_lio/math/random_bits.h"

namespace allan_lio {

/// Hashes numbers one after the other, each scrambled together with what came before.
class NumberHash {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic<T>::value && sizeof(T) <= sizeof(std::uint64_t), "a number");
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof(value));
    state_ = hash_bits(state_ ^ bits);
  }
  template <class Vector>
  void add_each(const Vector& values) {
    for (Eigen::Index i = 0; i < values.size(); ++i) add(values[i]);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0;
};

}  // namespace allan_lio
