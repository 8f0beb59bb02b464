// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Every field has a value of its own, so that none can stand in another's place.
#include "allan_lio/ros/state_message.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "allan_lio/ros/finite.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr double kScale = 8.0;  // [m] of the scene

LioResult result() {
  LioResult result;
  result.localizability.scale = kScale;
  result.localizability.probability << 0.1, 0.2, 0.3, 0.6, 0.7, 0.8;
  result.localizability.support << 0.05, 0.15, 0.25, 0.45, 0.55, 0.65;
  for (int k = 0; k < 6; ++k)
    for (int i = 0; i < 6; ++i) result.localizability.directions(i, k) = 10.0 * (k + 1) + i;
  return result;
}

TEST(StateMessage, HoldsTheSixDirectionsOneARowInRadiansAndMetres) {
  const LioSession session(simulated_robot(), "", {});
  const StatePtr message = to_state_message(result(), session);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(message->support[k], result().localizability.support[static_cast<Eigen::Index>(k)]);
    EXPECT_EQ(message->probability[k], result().localizability.probability[static_cast<Eigen::Index>(k)]);
    for (std::size_t i = 0; i < 6; ++i) {
      const double component = 10.0 * static_cast<double>(k + 1) + static_cast<double>(i);
      EXPECT_DOUBLE_EQ(message->directions[6 * k + i], i < 3 ? component / kScale : component) << k << " " << i;
    }
  }
}

TEST(StateMessage, TheCovarianceIsThatOfTheInertialStateAndTheExtrinsics) {
  LioResult at;
  for (int i = 0; i < kLioDof; ++i)
    for (int j = 0; j < kLioDof; ++j) at.covariance(i, j) = 100.0 * std::min(i, j) + std::max(i, j);
  const StatePtr message = to_state_message(at, LioSession(simulated_robot(), "", {}));
  std::vector<int> told;
  for (int i = 0; i < kNavDof; ++i) told.push_back(i);
  for (int i = 0; i < 6; ++i) told.push_back(kExtrinsicRotation + i);
  ASSERT_EQ(message->covariance.size(), told.size() * told.size());
  for (std::size_t i = 0; i < told.size(); ++i)
    for (std::size_t j = 0; j < told.size(); ++j)
      EXPECT_EQ(message->covariance[told.size() * i + j], at.covariance(told[i], told[j])) << i << ' ' << j;
  EXPECT_EQ(nav_covariance_of(*message), (at.covariance.topLeftCorner<kNavDof, kNavDof>()));
}

TEST(StateMessage, OfAScanThatWasNotRegisteredTheDirectionsAreTheAxes) {
  const LioSession session(simulated_robot(), "", {});
  const StatePtr message = to_state_message(LioResult(), session);
  EXPECT_TRUE(all_finite(*message));
  for (std::size_t i = 0; i < 36; ++i) EXPECT_EQ(message->directions[i], i % 7 == 0 ? 1.0 : 0.0) << i;
}

}  // namespace
}  // namespace allan_lio
