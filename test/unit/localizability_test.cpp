// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/localizability.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace allan_lio {
namespace {

PoseMatrix some_information(unsigned seed) {
  std::srand(seed);
  const PoseMatrix root = PoseMatrix::Random();
  return root * root.transpose() + 0.1 * PoseMatrix::Identity();
}

TEST(Localizability, ADirectionWithNoMoreThanFeignedInformationGetsNoSupport) {
  PoseMatrix information = PoseMatrix::Identity() * 1e5, feigned = PoseMatrix::Identity() * 10.0;
  information(3, 3) = 12.0;
  const Localizability l = judge_localizability(information, feigned, 5.0, 4.0);
  EXPECT_EQ(l.support[0], 0.0);
  EXPECT_NEAR(std::abs(l.directions(3, 0)), 1.0, 1e-12);
  for (int k = 1; k < 6; ++k) EXPECT_NEAR(l.support[k], 1.0 - 10.0 / 1e5, 1e-3);
}

TEST(Localizability, TheDirectionThatNoiseAloneTellsIsFoundWhateverTheOthersAre) {
  // Strong information about everything but one oblique direction, along which there is what noise feigns.
  const PoseVector unseen = (PoseVector() << 0.02, -0.1, 0.05, 0.6, 0.7, -0.3).finished();
  const PoseMatrix feigned = 30.0 * some_information(2);
  const PoseMatrix blind = PoseMatrix::Identity() - unseen * unseen.transpose() / unseen.squaredNorm();
  const PoseMatrix information = 1e6 * blind * some_information(3) * blind + feigned;
  const Localizability l = judge_localizability(information, feigned, 1.0, 4.0);
  EXPECT_NEAR(std::abs(l.directions.col(0).dot(unseen.normalized())), 1.0, 1e-6);
  EXPECT_LT(l.support[0], 1e-6);
  EXPECT_GT(l.support[1], 0.99);
  const PoseMatrix weighed = support_factor(l) * information;
  EXPECT_LT((weighed * unseen).norm(), 1e-6 * weighed.norm()) << "nothing is left along it";
}

TEST(Localizability, TheFactorScalesEachDirectionByItsSupport) {
  const PoseMatrix information = 100.0 * some_information(4);
  const double scale = 7.0;
  const Localizability l = judge_localizability(information, 10.0 * some_information(5), scale, 2.0);
  const PoseMatrix weighed = support_factor(l) * information;
  EXPECT_LT((weighed - weighed.transpose()).norm(), 1e-9 * weighed.norm());
  for (int k = 0; k < 6; ++k) {
    PoseVector v = l.directions.col(k);
    v.head<3>() /= scale;
    EXPECT_NEAR(v.dot(weighed * v), l.support[k] * v.dot(information * v), 1e-9 * information.norm());
  }
}

TEST(Localizability, FewPlanesMakeTheVerdictUncertainAndTheWeightSmall) {
  const PoseMatrix information = 1e4 * PoseMatrix::Identity(), feigned = 1e3 * PoseMatrix::Identity();
  const PoseMatrix directions = support_directions(information, feigned, 1.0);
  const auto judge = [&](double planes) {
    return judge_localizability(information, feigned, directions, PoseVector::Constant(1e8 / planes), 1.0, 5.0);
  };
  EXPECT_NEAR(judge(100).support[0], 0.9, 1e-3) << "1 - 1 / ratio";
  EXPECT_LT(judge(2).support[0], 0.1);
  EXPECT_LT(judge(2).probability[0], judge(20).probability[0]);
  // The ratio is 10 and the floor 5: half a ratio away, with a deviation of ratio / sqrt(planes).
  EXPECT_NEAR(judge(4).probability[0], 0.8413, 1e-3);
}

}  // namespace
}  // namespace allan_lio
