// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/edit_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace allan_lio {
namespace {

/// The table of Wagner and Fischer (1974), row by row.
std::size_t by_table(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

TEST(EditDistance, IsTheTextbooks) {
  EXPECT_EQ(EditDistance("kitten").to("sitting"), 3U);
  EXPECT_EQ(EditDistance("").to("imu"), 3U);
  EXPECT_EQ(EditDistance("imu").to(""), 3U);
  EXPECT_EQ(EditDistance("").to(""), 0U);
}

TEST(EditDistance, IsThatOfTheTableForAnyTwoWords) {
  std::mt19937 random(1);
  const auto word = [&random](std::size_t longest) {
    std::string text(random() % (longest + 1), '\0');
    for (char& c : text) c = "ab/\xff"[random() % 4];
    return text;
  };
  for (int i = 0; i < 2000; ++i) {
    const std::string a = word(EditDistance::kLongest), b = word(100);
    ASSERT_EQ(EditDistance(a).to(b), by_table(a, b)) << a << ' ' << b;
  }
}

TEST(EditDistance, CutsALongWordOff) { EXPECT_EQ(EditDistance(std::string(65, 'a')).to(std::string(64, 'a')), 0U); }

}  // namespace
}  // namespace allan_lio
