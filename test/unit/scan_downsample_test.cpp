// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/scan_downsample.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

namespace allan_lio {
namespace {

TEST(ScanDownsampler, KeepsTheFirstPointOfEveryCellOfDirection) {
  // An arc at 6 m, a point a degree: at this range a cell is 2/3 of a leaf on the face of the cube.
  std::vector<ScanPoint> points;
  for (int i = -40; i <= 40; ++i) {
    const double angle = i * M_PI / 180.0;
    points.push_back(
        {static_cast<float>(6.0 * std::cos(angle)), static_cast<float>(6.0 * std::sin(angle)), 0.1F, 0, i});
  }
  ScanDownsampler downsampler;
  std::vector<std::uint32_t> kept, again;
  downsampler.select(points, nullptr, 0.5, kept);
  ASSERT_GT(kept.size(), 15u);
  ASSERT_LT(kept.size(), 30u);
  EXPECT_EQ(kept.front(), 0u);
  for (std::size_t i = 1; i < kept.size(); ++i) EXPECT_GT(kept[i], kept[i - 1]);
  downsampler.select(points, &kept, 1.0, again);
  EXPECT_LT(again.size(), kept.size());
  downsampler.select(points, nullptr, 0.5, again);
  EXPECT_EQ(again, kept) << "nothing is left over from the call before";
}

TEST(ScanDownsampler, ATinyLeafKeepsEveryPointHoweverFar) {
  std::vector<ScanPoint> points;
  for (int i = 0; i < 500; ++i) points.push_back({200.0F, 0.37F * static_cast<float>(i) - 90.0F, -50.0F, 0, i});
  ScanDownsampler downsampler;
  std::vector<std::uint32_t> kept;
  downsampler.select(points, nullptr, 0.001, kept);
  EXPECT_EQ(kept.size(), points.size());
}

TEST(ScanDownsampler, AbsurdRangesAreCellsLikeOthers) {
  ScanDownsampler downsampler;
  std::vector<std::uint32_t> kept;
  const std::vector<ScanPoint> points = {
      {1e-42F, -1e-43F, 0, 0, 0}, {3, 0.1F, 0.1F, 0, 1}, {-2e30F, 3e37F, 1e30F, 0, 2}};
  downsampler.select(points, nullptr, 0.5, kept);
  EXPECT_EQ(kept, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(ScanDownsampler, NearAndFarPointsOfOneBeamAreBothKept) {
  ScanDownsampler downsampler;
  std::vector<std::uint32_t> kept;
  downsampler.select({{3, 0.1F, 0.1F, 0, 0}, {30, 1, 1, 0, 1}}, nullptr, 0.5, kept);
  EXPECT_EQ(kept.size(), 2u);
}

TEST(ScanDownsampler, WhatIsKeptOfANoisyWallLiesOnTheWall) {
  // A wall whose distance is just short of a multiple of the leaf. One point of every cube would keep, from the cubes
  // behind it, exactly the points that noise has carried there. It is near a border of the shells, too.
  constexpr double kLeaf = 0.4, kSigma = 0.02, kDistance = 4.0 - 0.03;
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> slope(-0.7, 0.7);
  std::normal_distribution<double> noise(0.0, kSigma);
  std::vector<ScanPoint> points;
  for (int i = 0; i < 40000; ++i) {
    const Eigen::Vector3d beam(1.0, slope(random), 0.3 * slope(random));
    const Eigen::Vector3d p = beam * kDistance + beam.normalized() * noise(random);
    points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0, i});
  }
  ScanDownsampler downsampler;
  std::vector<std::uint32_t> kept;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t from = 0; from < points.size(); from += 2000) {
    const std::vector<ScanPoint> scan(points.begin() + static_cast<std::ptrdiff_t>(from),
                                      points.begin() + static_cast<std::ptrdiff_t>(from) + 2000);
    downsampler.select(scan, nullptr, kLeaf, kept);
    for (const std::uint32_t i : kept) sum += scan[i].x - kDistance;
    count += kept.size();
  }
  ASSERT_GT(count, 500u);
  EXPECT_NEAR(sum / static_cast<double>(count), 0.0, 3.5 * kSigma / std::sqrt(static_cast<double>(count)));
}

}  // namespace
}  // namespace allan_lio
