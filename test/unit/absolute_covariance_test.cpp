// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/absolute_covariance.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "allan_lio/lio/view_error.h"

namespace allan_lio {
namespace {

constexpr double kStep = 0.05;  ///< [m], 1 sigma of what the position errs by from scan to scan
constexpr double kScan = 0.01;  ///< [m], 1 sigma of one scan

LioMatrix position_noise(double sigma) {
  LioMatrix out = LioMatrix::Zero();
  out.block<3, 3>(kPosition, kPosition).setIdentity();
  return sigma * sigma * out;
}

/// A scan of position only, that sees parts of the map with these shares.
UsedMeasurement measure(const LioState& state, const std::vector<double>& shares, double gain) {
  UsedMeasurement used;
  used.state = state;
  used.gain.setZero();
  used.gain.block<3, 3>(kPosition, 3).setIdentity();
  used.gain *= gain * kScan * kScan;
  used.support.setIdentity();
  used.view_kept = 1.0;
  used.view_noise.setZero();
  for (const double share : shares) {
    used.parts.push_back(PoseMatrix::Zero());
    used.parts.back().bottomRightCorner<3, 3>().diagonal().setConstant(share / (kScan * kScan));
  }
  return used;
}

TEST(AbsoluteCovariance, NothingIsLearntFromWhatWasPutIntoTheMapAtThePoseItself) {
  AbsoluteCovariance absolute;
  absolute.reset(LioMatrix::Zero());
  absolute.remember(LioState{}, false);
  absolute.add(position_noise(0.3));
  absolute.remember(LioState{}, false);  // a new place, and nothing old is seen from it
  for (int i = 0; i < 100; ++i) absolute.update(measure(LioState{}, {0.0, 1.0}, 0.5), false);
  const double sigma = std::sqrt(absolute.state()(kPosition, kPosition));
  EXPECT_NEAR(sigma, 0.3, 0.01);
  absolute.update(measure(LioState{}, {1.0, 0.0}, 1.0), false);  // the old place again, trusted wholly
  EXPECT_NEAR(std::sqrt(absolute.state()(kPosition, kPosition)), kScan, 1e-9);
}

TEST(AbsoluteCovariance, ThePoseIsKnownAgainstWhatWasJustMadeAndNotAgainstWhatLiesBeforeTheDrift) {
  AbsoluteCovariance absolute;
  absolute.reset(LioMatrix::Zero());
  LioState state;
  state.nav.T_world_imu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()));
  absolute.remember(state, false);
  absolute.add(position_noise(0.3));
  state.nav.T_world_imu.translation << 20.0, 0.0, 0.0;
  absolute.remember(state, false);
  const std::vector<PoseMatrix> relative = absolute.relative_to_parts(state, false);
  ASSERT_EQ(relative.size(), 2u);
  EXPECT_NEAR(relative[0](3, 3), 0.09, 1e-12);
  EXPECT_LT(relative[1].norm(), 1e-12);
  LioMatrix turn = LioMatrix::Zero();
  turn(kTheta + 2, kTheta + 2) = 1e-6;  // (0.001 rad)^2 after both
  absolute.add(turn);
  EXPECT_NEAR(absolute.relative_to_parts(state, false)[1](2, 2), 1e-6, 1e-15);
}

TEST(AbsoluteCovariance, IsTheSpreadOfTheErrorsThatAFilterMakes) {
  // The position walks, every fifth scan becomes a part of the map, and each scan is registered half to the newest part
  // and half to the one before, by a filter with a constant gain. No part is given up here.
  constexpr int kRuns = 4000, kScans = 30;
  constexpr double kGain = 0.3;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    double error = 0.0;  // truth less estimate
    std::vector<double> placed{0.0};
    for (int i = 1; i <= kScans; ++i) {
      error += kStep * normal(random);
      const double newest = placed.back(), before = placed.size() > 1 ? placed[placed.size() - 2] : newest;
      error -= kGain * (error - 0.5 * (newest + before) + kScan * normal(random));
      if (i % 5 == 0) placed.push_back(error);
    }
    sum += error * error / kRuns;
  }
  AbsoluteCovariance absolute;
  absolute.reset(LioMatrix::Zero());
  absolute.remember(LioState{}, false);
  std::size_t parts = 1;
  for (int i = 1; i <= kScans; ++i) {
    absolute.add(position_noise(kStep));
    std::vector<double> shares(parts, 0.0);
    shares[parts - 1] += 0.5;
    shares[parts > 1 ? parts - 2 : 0] += 0.5;
    absolute.update(measure(LioState{}, shares, kGain), false);
    if (i % 5 == 0) {
      absolute.remember(LioState{}, false);
      ++parts;
    }
  }
  EXPECT_NEAR(absolute.state()(kPosition, kPosition) / sum, 1.0, 4.0 * std::sqrt(2.0 / kRuns));
}

TEST(AbsoluteCovariance, PartsThatDifferLeastAreGivenUpAndTheResultStaysACovariance) {
  AbsoluteCovariance absolute;
  absolute.reset(LioMatrix::Zero());
  absolute.remember(LioState{}, false);
  for (int i = 0; i < 60; ++i) {
    absolute.add(position_noise(i == 20 ? 0.5 : 1e-3));
    absolute.update(measure(LioState{}, std::vector<double>(absolute.last_epochs().size(), 0.1), 0.01), false);
    absolute.remember(LioState{}, false);
  }
  const std::vector<std::uint32_t> last = absolute.last_epochs();
  EXPECT_LE(last.size(), std::size_t{AbsoluteCovariance::kMaxParts});
  EXPECT_EQ(last.back(), 60u);
  EXPECT_NE(std::find(last.begin(), last.end(), 20u), last.end()) << "the great step divides two parts to the end";
  const Eigen::SelfAdjointEigenSolver<LioMatrix> solver(absolute.state());
  EXPECT_GT(solver.eigenvalues().minCoeff(), -1e-12);
}

TEST(AbsoluteCovariance, AnErrorThatIsFoundIsAddedOnceAndThePartsMadeSinceErrAlike) {
  AbsoluteCovariance absolute;
  absolute.reset(1e-8 * LioMatrix::Identity());
  absolute.remember(LioState{}, false);
  absolute.add(position_noise(0.1));
  absolute.remember(LioState{}, false);
  PoseVector step;
  step << 0.0, 0.0, 0.0, 0.8, 0.0, 0.0;
  absolute.add_surprise(step, LioState{}, 0);
  EXPECT_NEAR(std::sqrt(absolute.state()(kPosition, kPosition)), 0.8, 1e-6);
  const std::vector<PoseMatrix> parts = absolute.relative_to_parts(LioState{}, false);
  EXPECT_NEAR(std::sqrt(parts[0](3, 3)), 0.8, 1e-3);
  EXPECT_LT(std::sqrt(parts[1](3, 3)), 1e-3);
  // Found again, it is not quite the same.
  step << 0.0, 0.0, 1e-3, 0.79, 0.03, 0.0;
  for (int i = 0; i < 10; ++i) absolute.add_surprise(step, LioState{}, 0);
  EXPECT_LT(std::sqrt(absolute.state()(kPosition, kPosition)), 0.81);
}

TEST(AbsoluteCovariance, AnErrorInTheHeadingMovesThePartsThatWereMadeFarAway) {
  LioState there, here;
  there.nav.T_world_imu.translation.x() = 20.0;
  AbsoluteCovariance absolute;
  absolute.reset(1e-12 * LioMatrix::Identity());
  absolute.remember(here, false);
  absolute.remember(there, false);
  PoseVector step;
  step << 0.0, 0.0, 0.01, 0.0, 0.0, 0.0;
  absolute.add_surprise(step, here, 0);
  const std::vector<PoseMatrix> parts = absolute.relative_to_parts(here, false);
  EXPECT_NEAR(std::sqrt(parts[0](2, 2)), 0.01, 1e-4);
  EXPECT_LT(std::sqrt(parts[1](2, 2)), 1e-4) << "it has turned about the pose, as the pose did";
  EXPECT_LT(std::sqrt(parts[1](4, 4)), 1e-4);
}

TEST(ViewError, GoesTowardsTheNoiseAndForgetsItself) {
  ViewError view;
  view.cross.setOnes();
  const PoseMatrix noise = 4.0 * PoseMatrix::Identity();
  for (int i = 0; i < 200; ++i) view.change(0.9, noise);
  EXPECT_LT((view.own - noise).norm(), 1e-9);
  EXPECT_LT(view.cross.norm(), 1e-8);
}

}  // namespace
}  // namespace allan_lio
