// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/pose_innovation.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <random>

namespace allan_lio {
namespace {

PoseMatrix random_covariance(unsigned seed, double size) {
  std::srand(seed);
  const PoseMatrix root = PoseMatrix::Random();
  return size * size * (root * root.transpose() + 0.1 * PoseMatrix::Identity());
}

PoseVector draw(const PoseMatrix& covariance, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  PoseVector z;
  for (int i = 0; i < 6; ++i) z[i] = normal(random);
  return covariance.llt().matrixL() * z;
}

TEST(PoseInnovation, IsChiSquareWithSixDegreesOfFreedomForAnHonestFilter) {
  const PoseMatrix noise = random_covariance(1, 1e-3), prior = random_covariance(2, 2e-3);
  const PoseMatrix information = noise.inverse();
  const Localizability seen = judge_localizability(information, PoseMatrix::Zero(), 7.0, 4.0);
  std::mt19937_64 random(5);
  constexpr int kRuns = 4000;
  double sum = 0.0;
  PoseMatrix second = PoseMatrix::Zero();
  for (int run = 0; run < kRuns; ++run) {
    const PoseVector innovation = draw(noise, random) + draw(prior, random);
    const PoseInnovation found = pose_innovation(information, information * innovation, prior, seen);
    ASSERT_EQ(found.dof, 6);
    ASSERT_NEAR(found.whitened.squaredNorm(), found.nis, 1e-9 * found.nis);
    sum += found.nis / kRuns;
    second += found.whitened * found.whitened.transpose() / kRuns;
  }
  const double three_sigma = 3.0 * std::sqrt(12.0 / kRuns);
  EXPECT_NEAR(sum, 6.0, three_sigma);
  EXPECT_LT((second - PoseMatrix::Identity()).cwiseAbs().maxCoeff(), 0.12) << "white in every component";
}

TEST(PoseInnovation, LogDetIsThatOfTheCovarianceInMetres) {
  constexpr double kScale = 7.0;
  const PoseMatrix noise = random_covariance(1, 1e-3), prior = random_covariance(2, 2e-3);
  const PoseMatrix information = noise.inverse();
  const Localizability seen = judge_localizability(information, PoseMatrix::Zero(), kScale, 4.0);
  const PoseInnovation found = pose_innovation(information, PoseVector::Ones(), prior, seen);
  // Rotations count scale metres a radian, three of them.
  EXPECT_NEAR(found.log_det, std::log((noise + prior).determinant()) + 6.0 * std::log(kScale), 1e-9);
}

TEST(PoseInnovation, DoesNotDependOnTheScaleThatMakesMetresOfRadians) {
  const PoseMatrix information = random_covariance(3, 1e-3).inverse(), prior = random_covariance(4, 1e-3);
  const PoseVector gradient = PoseVector::LinSpaced(-1e3, 2e3);
  const auto nis = [&](double scale) {
    return pose_innovation(information, gradient, prior,
                           judge_localizability(information, PoseMatrix::Zero(), scale, 4.0))
        .nis;
  };
  EXPECT_NEAR(nis(1.0) / nis(30.0), 1.0, 1e-6);
}

TEST(PoseInnovation, AnUnsupportedDirectionDoesNotCount) {
  PoseMatrix information = 1e6 * PoseMatrix::Identity(), feigned = PoseMatrix::Zero();
  information(3, 3) = feigned(3, 3) = 50.0;  // what is seen along x is mere noise of the map
  const Localizability seen = judge_localizability(information, feigned, 1.0, 4.0);
  PoseVector gradient = PoseVector::Zero();
  gradient[3] = 1e4;
  const PoseInnovation found = pose_innovation(information, gradient, 1e-6 * PoseMatrix::Identity(), seen);
  EXPECT_EQ(found.dof, 5);
  EXPECT_NEAR(found.nis, 0.0, 1e-12);
  const Localizability none = judge_localizability(feigned, feigned + PoseMatrix::Identity(), 1.0, 4.0);
  EXPECT_EQ(pose_innovation(feigned, gradient, PoseMatrix::Identity(), none).dof, 0);
}

}  // namespace
}  // namespace allan_lio
