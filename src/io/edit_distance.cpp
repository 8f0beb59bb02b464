// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/edit_distance.h"

#include <algorithm>

namespace allan_lio {

EditDistance::EditDistance(const std::string& word) : length_(std::min(word.size(), kLongest)) {
  for (std::size_t i = 0; i < length_; ++i) places_[static_cast<unsigned char>(word[i])] |= std::uint64_t{1} << i;
}

std::size_t EditDistance::to(const std::string& other) const {
  if (length_ == 0) return other.size();
  const std::uint64_t last = std::uint64_t{1} << (length_ - 1);
  // Where the column rises and falls from one character of the word to the next; the paper's Pv and Mv.
  std::uint64_t rises = ~std::uint64_t{0}, falls = 0;
  std::size_t distance = length_;
  for (const char c : other) {
    const std::uint64_t equal = places_[static_cast<unsigned char>(c)];
    const std::uint64_t across = (((equal & rises) + rises) ^ rises) | equal;
    std::uint64_t grows = falls | ~(across | rises), shrinks = rises & across;  // against the column before
    if ((grows & last) != 0) ++distance;
    if ((shrinks & last) != 0) --distance;
    grows = (grows << 1U) | 1U;
    shrinks <<= 1U;
    const std::uint64_t down = equal | falls;
    rises = shrinks | ~(down | grows);
    falls = grows & down;
  }
  return distance;
}

}  // namespace allan_lio
