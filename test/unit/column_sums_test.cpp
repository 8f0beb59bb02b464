// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/column_sums.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>

namespace allan_lio {
namespace {

TEST(ColumnSums, AreThoseOfAMapByTheSquareThatAPlaceLiesIn) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ColumnSums sums;
  for (const std::size_t points : {0U, 1U, 40U, 3000U}) {  // with fewer columns than points, and with as many
    for (const double reach : {3.0, 3000.0}) {
      std::map<std::pair<double, double>, PoseVector> expected;
      sums.begin(points);
      for (std::size_t i = 0; i < points; ++i) {
        const Eigen::Vector3d place = reach * Eigen::Vector3d(unit(random), unit(random), unit(random));
        const PoseVector summand = PoseVector::Random();
        sums.add(place, summand);
        auto& sum =
            expected.try_emplace({std::floor(place.x()), std::floor(place.y())}, PoseVector::Zero()).first->second;
        sum += summand;
      }
      PoseVector squares = PoseVector::Zero();
      for (const auto& column : expected) squares += column.second.cwiseAbs2();
      EXPECT_LT((sums.squares() - squares).norm(), 1e-9 * (1.0 + squares.norm())) << points << " points in " << reach;
    }
  }
}

TEST(ColumnSums, TwoSidesOfZeroAreTwoColumnsAndTheHeightIsNone) {
  ColumnSums sums;
  sums.begin(3);
  sums.add({0.2, 0.2, -5.0}, PoseVector::Ones());
  sums.add({-0.2, 0.2, 0.0}, PoseVector::Ones());
  sums.add({0.8, 0.9, 50.0}, PoseVector::Ones());
  EXPECT_EQ(sums.squares(), PoseVector::Constant(5.0));
}

}  // namespace
}  // namespace allan_lio
