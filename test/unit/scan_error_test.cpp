// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/scan_error.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "allan_lio/lio/absolute_covariance.h"
#include "allan_lio/lio/update_step.h"

namespace allan_lio {
namespace {

constexpr double kDuration = 0.1;    ///< [s]
constexpr double kGyroNoise = 2e-4;  ///< N_g [rad/s/sqrt(Hz)]
constexpr double kScanNoise = 1e-5;  ///< 1 sigma of a scan's attitude [rad]

const Eigen::Vector3d kGyroPsd = Eigen::Vector3d::Constant(kGyroNoise * kGyroNoise);

struct Scan {
  double end;   ///< error of the attitude at the scan's end, 0 at its begin [rad]
  double mean;  ///< mean error of the attitudes at which the points were put together [rad]
};

/// One axis: the attitude's error walks by the gyroscope's noise, and each point lies as its own time's error says.
Scan fly(std::mt19937_64& random) {
  constexpr int kPoints = 50;
  std::normal_distribution<double> step(0.0, kGyroNoise * std::sqrt(kDuration / kPoints));
  Scan out{0.0, 0.0};
  for (int i = 0; i < kPoints; ++i) {
    const double before = out.end;
    out.end -= step(random);
    out.mean += 0.5 * (before + out.end) / kPoints;
  }
  return out;
}

TEST(ScanError, TheNoiseOfDeskewingIsWhatAMonteCarloFinds) {
  constexpr int kRuns = 20000;
  std::mt19937_64 random(11);
  double noise = 0.0, with_end = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const Scan scan = fly(random);
    const double s = scan.end - scan.mean;
    noise += s * s / kRuns;
    with_end += s * scan.end / kRuns;
  }
  const ScanError error = deskewing_error(kDuration, kGyroPsd);
  const double tolerance = 4.0 * std::sqrt(2.0 / kRuns);
  EXPECT_NEAR(noise / error.noise(1, 1), 1.0, tolerance);
  EXPECT_NEAR(with_end / error.with_state(kTheta + 1, 1), 1.0, tolerance);
}

TEST(ScanError, WhatIsNotDeskewedHasNone) {
  EXPECT_EQ(deskewing_error(0.0, kGyroPsd).noise, PoseMatrix(PoseMatrix::Zero()));
}

Belief some_belief() {
  std::srand(8);
  const Eigen::Matrix<double, kLioDof + 6, kLioDof + 6> root =
      0.01 * Eigen::Matrix<double, kLioDof + 6, kLioDof + 6>::Random();
  const Eigen::Matrix<double, kLioDof + 6, kLioDof + 6> all = root * root.transpose();
  Belief belief;
  belief.covariance = all.topLeftCorner<kLioDof, kLioDof>();
  belief.view.cross = all.topRightCorner<kLioDof, 6>();
  belief.view.own = all.bottomRightCorner<6, 6>();
  return belief;
}

TEST(ScanError, AStepWithItIsTheTextbooksUpdateOfTheStateThatHoldsViewAndScan) {
  // State, view and the scan's noise in one vector, of which rows see the pose less view less scan's error.
  constexpr int kAll = kLioDof + 12;
  const Belief belief = some_belief();
  const ScanError scan = deskewing_error(1.0, Eigen::Vector3d(1e-6, 2e-6, 3e-6));
  Eigen::Matrix<double, kAll, kAll> p = Eigen::Matrix<double, kAll, kAll>::Zero();
  p.topLeftCorner<kLioDof, kLioDof>() = belief.covariance;
  p.block<kLioDof, 6>(0, kLioDof) = belief.view.cross;
  p.block<6, kLioDof>(kLioDof, 0) = belief.view.cross.transpose();
  p.block<6, 6>(kLioDof, kLioDof) = belief.view.own;
  p.block<kLioDof, 6>(0, kLioDof + 6) = scan.with_state;
  p.block<6, kLioDof>(kLioDof + 6, 0) = scan.with_state.transpose();
  p.bottomRightCorner<6, 6>() = scan.noise;
  std::srand(9);
  const Eigen::Matrix<double, 8, 6> rows = Eigen::Matrix<double, 8, 6>::Random();
  const Eigen::Matrix<double, 8, 1> z = 0.01 * Eigen::Matrix<double, 8, 1>::Random();
  const double variance = 1e-4;
  Eigen::Matrix<double, 6, kAll> seen = Eigen::Matrix<double, 6, kAll>::Zero();
  seen.leftCols<6>().setIdentity();
  seen.middleCols<6>(kLioDof) = -PoseMatrix::Identity();
  seen.rightCols<6>() = -PoseMatrix::Identity();
  const Eigen::Matrix<double, 8, kAll> h = rows * seen;
  const Eigen::Matrix<double, 8, 8> s = h * p * h.transpose() + variance * Eigen::Matrix<double, 8, 8>::Identity();
  const Eigen::Matrix<double, kAll, 8> gain = p * h.transpose() * s.inverse();
  const Eigen::Matrix<double, kAll, kAll> expected = p - gain * h * p;

  NormalEquations equations;
  equations.information.topLeftCorner<6, 6>() = rows.transpose() * rows / variance;
  equations.gradient.head<6>() = -rows.transpose() * z / variance;
  equations.spread(lidar_pose_rows(LioState{}, false));
  const UpdateStep step = solve_step(LioState{}, LioState{}, belief, scan, equations, false);
  constexpr double kRounding = 1e-9;
  EXPECT_LT((step.step + (gain * z).head<kLioDof>()).norm(), kRounding * step.step.norm());
  EXPECT_LT((step.posterior.covariance - expected.topLeftCorner<kLioDof, kLioDof>()).norm(),
            kRounding * belief.covariance.norm());
  EXPECT_LT((step.posterior.view.cross - expected.block<kLioDof, 6>(0, kLioDof)).norm(),
            kRounding * belief.covariance.norm());
  EXPECT_EQ(step.posterior.view.own, belief.view.own);
}

TEST(ScanError, TheAbsoluteCovarianceHoldsTheErrorThatEveryScansDeskewingLeaves) {
  // Attitude about one axis: it is predicted through the scan, then moved by a constant gain towards what the points,
  // which lie at their own times' attitudes, say. The map is perfect.
  constexpr int kRuns = 4000, kScans = 40;
  constexpr double kGain = 0.9;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    double error = 0.0;
    for (int i = 0; i < kScans; ++i) {
      const Scan scan = fly(random);
      const double seen = error + scan.mean + kScanNoise * normal(random);
      error += scan.end - kGain * seen;
    }
    sum += error * error / kRuns;
  }
  UsedMeasurement used;
  used.gain.setZero();
  used.gain(kTheta, 0) = kGain * kScanNoise * kScanNoise;
  used.support.setIdentity();
  used.parts = {PoseMatrix::Zero()};
  used.parts[0](0, 0) = 1.0 / (kScanNoise * kScanNoise);
  used.view_noise.setZero();
  used.view_kept = 1.0;
  used.scan = deskewing_error(kDuration, kGyroPsd);
  LioMatrix walked = LioMatrix::Zero();
  walked(kTheta, kTheta) = kGyroPsd.x() * kDuration;
  AbsoluteCovariance absolute;
  absolute.reset(LioMatrix::Zero());
  absolute.remember(LioState{}, false);
  for (int i = 0; i < kScans; ++i) {
    absolute.add(walked);
    absolute.update(used, false);
  }
  EXPECT_NEAR(absolute.state()(kTheta, kTheta) / sum, 1.0, 4.0 * std::sqrt(2.0 / kRuns));
}

}  // namespace
}  // namespace allan_lio
