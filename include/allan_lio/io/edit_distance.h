// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace allan_lio {

/// Levenshtein's distance (insertions, deletions and replacements of one character) of one word from many, a column of
/// the table at a time as the bits of a number: G. Myers, "A fast bit-vector algorithm for approximate string matching
/// based on dynamic programming", J. ACM 46 (1999), in the form of H. Hyyrö (2003) for whole words.
class EditDistance {
 public:
  static constexpr std::size_t kLongest = 64;  ///< [characters] of the word; what is longer is cut off

  explicit EditDistance(const std::string& word);

  std::size_t to(const std::string& other) const;

 private:
  std::size_t length_;
  std::array<std::uint64_t, 256> places_{};  ///< of each character in the word, a bit a place
};

}  // namespace allan_lio
