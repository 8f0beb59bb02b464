// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/localizability.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

TEST(Localizability, ADirectionWithNoMoreThanFeignedInformationGetsNoSupport) {
  PoseMatrix information = PoseMatrix::Identity() * 1e5, feigned = PoseMatrix::Identity() * 10.0;
  information(3, 3) = 12.0;
  const Localizability l = judge_localizability(information, feigned, 5.0, 4.0);
  EXPECT_EQ(l.support[0], 0.0);
  EXPECT_NEAR(std::abs(l.directions(3, 0)), 1.0, 1e-12);
  for (int k = 1; k < 6; ++k) EXPECT_NEAR(l.support[k], 1.0 - 4.0 * 10.0 / 1e5, 1e-2);
}

TEST(Localizability, WithoutFloorAllIsKept) {
  const PoseMatrix information = (PoseVector() << 1, 2, 3, 4, 5, 6).finished().asDiagonal();
  const Localizability l = judge_localizability(information, PoseMatrix::Identity(), 3.0, 0.0);
  EXPECT_EQ(l.support, PoseVector(PoseVector::Ones()));
  EXPECT_LT((support_factor(l) - PoseMatrix::Identity()).norm(), 1e-12);
}

TEST(Localizability, TheFactorScalesEachDirectionByItsSupport) {
  PoseMatrix information = PoseMatrix::Identity() * 100.0;
  information(0, 0) = 4e4;
  information(0, 4) = information(4, 0) = 50.0;
  const double scale = 7.0;
  const Localizability l = judge_localizability(information, PoseMatrix::Identity() * 20.0, scale, 2.0);
  const PoseMatrix factor = support_factor(l);
  const PoseMatrix weighed = factor * information * factor.transpose();
  PoseVector to_metres;
  to_metres << 1 / scale, 1 / scale, 1 / scale, 1, 1, 1;
  const PoseMatrix scaled = to_metres.asDiagonal() * weighed * to_metres.asDiagonal();
  const PoseMatrix original = to_metres.asDiagonal() * information * to_metres.asDiagonal();
  for (int k = 0; k < 6; ++k) {
    const PoseVector v = l.directions.col(k);
    EXPECT_NEAR(v.dot(scaled * v), l.support[k] * v.dot(original * v), 1e-9);
  }
}

}  // namespace
}  // namespace allan_lio
