// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/chi_square.h"

#include <gtest/gtest.h>

#include <thread>

namespace allan_lio {
namespace {

// Two robots' filters in one nodelet manager ask at once. What was wrong shows in scripts/test --tsan only.
TEST(ChiSquare, TwoThreadsMayAskAtOnce) {
  const double expected = chi_square_quantile(0.95, 6.0);
  double first = 0.0, second = 0.0;
  std::thread one([&first] { first = chi_square_quantile(0.95, 6.0); });
  std::thread two([&second] { second = chi_square_quantile(0.95, 6.0); });
  one.join();
  two.join();
  EXPECT_EQ(first, expected);
  EXPECT_EQ(second, expected);
}

}  // namespace
}  // namespace allan_lio
