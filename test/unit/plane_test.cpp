// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace allan_lio {
namespace {

constexpr double kRangeNoise = 0.02;  ///< 1 sigma [m]
constexpr int kPoints = 400;
const PlaneLimits kLimits{kRangeNoise * kRangeNoise, 0.03, 0.15, 3.0, 12, 100};

/// Ground of half a metre seen from far away, along a beam `cosine` = sin(elevation) above it; `rough`: 1 sigma of the
/// ground itself [m].
PlaneSums ground(double cosine, double rough, unsigned seed) {
  const Eigen::Vector3d beam(std::sqrt(1.0 - cosine * cosine), 0.0, -cosine);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kRangeNoise), height(0.0, rough);
  std::uniform_real_distribution<double> place(-0.6, 0.6);
  PlaneSums sums;
  while (sums.count < kPoints) {
    Eigen::Vector3d p(place(random), 0.4 * place(random), rough > 0.0 ? height(random) : 0.0);
    p += noise(random) * beam;
    if (std::abs(p.x()) < 0.25) sums.add(p, beam);  // the voxel's border cuts what was measured
  }
  return sums;
}

Plane fitted(const PlaneSums& sums) {
  Plane plane;
  EXPECT_TRUE(fit_plane(sums, Eigen::Vector3d::Zero(), kLimits, plane));
  return plane;
}

TEST(Plane, OfTheRangeNoiseOnlyWhatLiesAcrossMakesItsCentreUncertain) {
  constexpr double kCosine = 0.3;
  const double across = kCosine * kRangeNoise;
  std::vector<double> variances;  // now and then chance looks like structure
  for (unsigned seed = 0; seed < 51; ++seed) variances.push_back(fitted(ground(kCosine, 0.0, seed)).center_variance);
  std::nth_element(variances.begin(), variances.begin() + 25, variances.end());
  EXPECT_NEAR(variances[25], across * across / 100, 0.2 * across * across / 100);
}

TEST(Plane, ItsCentreErrsNoMoreThanItSays) {
  constexpr double kCosine = 0.3;
  constexpr int kRuns = 300;
  double sum = 0.0;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const Plane plane = fitted(ground(kCosine, 0.0, seed));
    sum += plane.distance({0, 0, 0}) * plane.distance({0, 0, 0}) / plane.center_variance / kRuns;
  }
  // 400 points are counted as 100.
  EXPECT_NEAR(sum, 0.25, 4.0 * 0.25 * std::sqrt(2.0 / kRuns));
}

TEST(Plane, RoughnessThatTheRangeNoiseWouldHideIsSeenAtGrazingIncidence) {
  constexpr double kCosine = 0.15, kRough = 0.012;
  const PlaneSums sums = ground(kCosine, kRough, 3);
  const Plane plane = fitted(sums);
  EXPECT_LT(plane.thickness, kRangeNoise * kRangeNoise) << "thinner than a wall seen head-on";
  EXPECT_GT(plane.center_variance, 0.7 * kRough * kRough / 4) << "structure does not average out";
  PlaneSums unknown = sums;
  unknown.beams.setZero();
  EXPECT_LT(fitted(unknown).center_variance, 0.2 * plane.center_variance) << "without the beams it passes for noise";
}

TEST(Plane, BeamsThatAreNotKnownCountAsHeadOn) {
  PlaneSums sums = ground(1.0, 0.0, 4);
  const double known = fitted(sums).center_variance;
  sums.beams.setZero();
  EXPECT_NEAR(fitted(sums).center_variance, known, 1e-3 * known);
}

TEST(Plane, AlongASurfaceTheBeamsNoiseHasAFloor) {
  const double floor = kLeastSquaredCosine * kRangeNoise * kRangeNoise;
  EXPECT_NEAR(fitted(ground(0.01, 0.0, 5)).center_variance, floor / 100, 1e-3 * floor / 100);
}

}  // namespace
}  // namespace allan_lio
