// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/residual_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace allan_lio {
namespace {

constexpr double kRange = 0.02;  // [m]
const ResidualOptions kOptions{kRange * kRange, 3.0, 2.0, false};

/// As point_to_plane makes it, at the identity.
PoseVector row_of(const Eigen::Vector3d& q, const Eigen::Vector3d& direction) {
  PoseVector row;
  row << q.cross(direction), direction;
  return row;
}

Plane ground() {
  Plane plane;
  plane.center = {6.0, 3.0, -1.5};
  plane.normal = {0, 0, 1};
  plane.lean_1 = {0.02, 0, 0};
  plane.lean_2 = {0, 0.05, 0};
  plane.center_variance = 1e-6;
  return plane;
}

const Eigen::Vector3d kPoint(6.0, 3.0, -1.5);
const double kAcross = kRange * kRange * 1.5 * 1.5 / kPoint.squaredNorm();  ///< of the range's noise, along the normal

ResidualVariance noise_of(const ResidualOptions& options, const ScanUncertainty& scan, const Plane& plane,
                          const Eigen::Vector3d& q) {
  return ResidualNoise(options, scan).of(plane, q, plane.normal, q, row_of(q, plane.lean_1), row_of(q, plane.lean_2));
}

TEST(ResidualNoise, TheLeanTermIsTheSpreadOfWhatLeaningNormalsMakeOfThePosesError) {
  const Eigen::Vector3d q(6.2, 3.1, -1.5);
  const Plane plane = ground();
  ScanUncertainty scan;
  std::srand(7);
  const PoseMatrix root = PoseMatrix::Random();
  scan.iterate = 0.1 * root * root.transpose();
  const PoseMatrix factor = scan.iterate.llt().matrixL();
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector3d dn = normal(random) * plane.lean_1 + normal(random) * plane.lean_2;
    PoseVector x;
    for (int k = 0; k < 6; ++k) x[k] = normal(random);
    const double z = row_of(q, dn).dot(factor * x);
    sum += z * z;
  }
  const double spread = sum / kDraws;
  EXPECT_NEAR(noise_of(kOptions, scan, plane, q).lean, ResidualNoise::kLooks * spread,
              0.03 * ResidualNoise::kLooks * spread);
}

TEST(ResidualNoise, ThePosesErrorIsThatAgainstThePlanesPartOfTheMap) {
  const Plane plane = ground();
  const PoseVector lean_1 = row_of(kPoint, plane.lean_1), lean_2 = row_of(kPoint, plane.lean_2);
  ScanUncertainty drifted;  // metres from where the run began
  drifted.iterate = PoseMatrix::Identity();
  const ResidualNoise noise(kOptions, drifted);
  const auto lean = [&](const PoseMatrix* part) {
    return noise.of(plane, kPoint, plane.normal, kPoint, lean_1, lean_2, part).lean;
  };
  const PoseMatrix recent = 1e-4 * PoseMatrix::Identity(), older = 9.0 * PoseMatrix::Identity();
  EXPECT_NEAR(lean(&recent), 1e-4 * lean(nullptr), 1e-12 * lean(nullptr)) << "the part has drifted along";
  EXPECT_EQ(lean(&older), lean(nullptr)) << "what the iterations have measured counts too";
}

TEST(ResidualNoise, AWellKnownPoseMakesNothingOfLeaningNormals) {
  ScanUncertainty scan;
  scan.iterate = 1e-10 * PoseMatrix::Identity();
  const ResidualVariance noise = noise_of(kOptions, scan, ground(), kPoint);
  EXPECT_EQ(noise.lean, 0.0);
  EXPECT_NEAR(noise.own, kAcross, 1e-12);
  EXPECT_EQ(noise.plane, 1e-6);
}

TEST(ResidualNoise, OfTheRangesNoiseTheNormalSeesTheCosine) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, kRange);
  const Plane plane = ground();
  double sum = 0.0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double z = plane.normal.dot(kPoint.normalized() * normal(random));
    sum += z * z;
  }
  EXPECT_NEAR(noise_of(kOptions, {}, plane, kPoint).own, sum / kDraws, 0.02 * sum / kDraws);
}

TEST(ResidualNoise, AGrazingBeamIsUncertainByItsSpot) {
  ResidualOptions options = kOptions;
  options.divergence = 0.003;
  const Plane plane = ground();
  // 20 m away and 2 m up: of the spot's quarter, 0.75 mrad * 20 m, all but a percent lies across the normal.
  const double range = std::hypot(20.0, 2.0);
  const double spot = 0.25 * 0.003 * range, sine = 20.0 / range;
  EXPECT_NEAR(noise_of(options, {}, plane, {20.0, 0.0, -2.0}).own, 0.02 * kRange * kRange + spot * spot * sine * sine,
              1e-12);
  EXPECT_NEAR(noise_of(options, {}, plane, {0.0, 0.0, -2.0}).own, kRange * kRange, 1e-12) << "straight on";
}

TEST(ResidualNoise, AWrongVelocitySmearsAlongItsDirectionOnly) {
  ScanUncertainty scan;
  scan.smear = Eigen::Vector3d(0.0, 0.0, 0.04).asDiagonal();
  EXPECT_NEAR(noise_of(kOptions, scan, ground(), kPoint).own, kAcross + 0.04, 1e-12);
  scan.smear = Eigen::Vector3d(0.04, 0.04, 0.0).asDiagonal();
  EXPECT_NEAR(noise_of(kOptions, scan, ground(), kPoint).own, kAcross, 1e-12);
}

TEST(ResidualNoise, KrScalesThePointsNoiseOnRoughSurfacesToo) {
  ResidualOptions options = kOptions;
  Plane rough = ground();
  rough.thickness = 9 * kRange * kRange;
  for (const double k_r : {0.3, 1.0, 3.0}) {
    options.k_r = k_r;
    const ResidualVariance noise = noise_of(options, {}, rough, kPoint);
    EXPECT_DOUBLE_EQ(noise.own, k_r * k_r * 9 * kRange * kRange);
    EXPECT_EQ(noise.plane, 1e-6) << "the map's noise is not the point's";
  }
}

}  // namespace
}  // namespace allan_lio
