// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/decouple.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace allan_lio {
namespace {

constexpr double kLean = 0.01;   // [rad], 1 sigma of the normals
constexpr double kWeight = 1e4;  // [1/m^2] of a residual
constexpr double kFloor = 4.0;   // of the support
constexpr double kScale = 10.0;  // [m]
constexpr int kPlanes = 400;

/// Planes about a sensor: where they are and which way they truly face.
struct Surface {
  std::vector<Eigen::Vector3d> places, normals;
};

/// Ground 1.5 m below, within 15 m.
Surface flat_ground() {
  Surface out;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-15.0, 15.0);
  for (int i = 0; i < kPlanes; ++i) {
    out.places.push_back({place(random), place(random), -1.5});
    out.normals.push_back({0.0, 0.0, 1.0});
  }
  return out;
}

/// The lining of a tunnel about the x axis that bends to the left with this radius [m].
Surface bent_tunnel(double bend) {
  Surface out;
  std::mt19937 random(2);
  std::uniform_real_distribution<double> along(-25.0, 25.0), angle(-0.6, 3.7);
  for (int i = 0; i < kPlanes; ++i) {
    const double s = along(random), a = angle(random);
    const Eigen::AngleAxisd heading(s / bend, Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d axis(bend * std::sin(s / bend), bend * (1.0 - std::cos(s / bend)), 0.0);
    const Eigen::Vector3d outwards = heading * Eigen::Vector3d(0.0, std::cos(a), std::sin(a));
    out.places.push_back(axis + 3.0 * outwards);
    out.normals.push_back(-outwards);
  }
  return out;
}

PoseVector row_of(const Eigen::Vector3d& q, const Eigen::Vector3d& n) {
  PoseVector row;
  row << q.cross(n), n;
  return row;
}

/// A scan's view of it through noisy normals.
struct View {
  PoseMatrix information = PoseMatrix::Zero(), feigned = PoseMatrix::Zero();
  Localizability localizability;
};

View look(const Surface& surface, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> lean(0.0, kLean);
  View view;
  std::vector<PoseVector> rows;
  std::vector<Eigen::Matrix<double, 6, 2>> leans;
  for (std::size_t i = 0; i < surface.places.size(); ++i) {
    const Eigen::Vector3d &q = surface.places[i], &n = surface.normals[i];
    const Eigen::Vector3d a = n.unitOrthogonal(), b = n.cross(a);
    rows.push_back(row_of(q, n + lean(random) * a + lean(random) * b));
    leans.emplace_back();
    leans.back() << kLean * row_of(q, a), kLean * row_of(q, b);
    view.information += kWeight * rows.back() * rows.back().transpose();
    view.feigned += kWeight * leans.back() * leans.back().transpose();
  }
  const auto noise = [&](const PoseVector& direction) {
    PoseMatrix out = PoseMatrix::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i)
      out += kWeight * kWeight * (leans[i].transpose() * direction).squaredNorm() * rows[i] * rows[i].transpose();
    return out;
  };
  view.localizability = judge_localizability(view.information, view.feigned, kScale, kFloor);
  decouple(view.information, view.feigned, noise, view.localizability);
  return view;
}

int pure_count(const Localizability& l) {
  int count = 0;
  for (const bool pure : l.pure) count += pure ? 1 : 0;
  return count;
}

TEST(Decouple, OverFlatGroundTheTwoWaysAndTheHeadingAreNothingElse) {
  int pure = 0, weak = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const View view = look(flat_ground(), seed);
    pure += pure_count(view.localizability);
    weak += static_cast<int>((view.localizability.support.array() < kSupported).count());
  }
  EXPECT_EQ(weak, 200 * 3);
  EXPECT_GT(pure, weak * 95 / 100) << "noise is told for what it is";
}

TEST(Decouple, ThenNothingOfAWayIsMeasuredThroughTilt) {
  const PoseVector x = PoseVector::Unit(3);
  for (unsigned seed = 0; seed < 50; ++seed) {
    const View view = look(flat_ground(), seed);
    if (pure_count(view.localizability) < 3) continue;
    // What is left of a metre is the slope of the ground, which is no better known than that.
    const PoseVector taken_for = without_pure(view.localizability) * x;
    EXPECT_LT(taken_for.head<3>().norm(), 1e-9);
    EXPECT_LT(taken_for.tail<3>().norm(), 5.0 * kLean / std::sqrt(kPlanes));
    // Tilt and height are measured as before.
    const PoseMatrix weighed = weighed_information(view.information, view.localizability);
    for (const int k : {0, 1, 2 + 3}) EXPECT_NEAR(weighed(k, k), view.information(k, k), 0.02 * view.information(k, k));
  }
}

TEST(Decouple, TheBendOfATunnelStays) {
  // A metre on the way turns it by 1 / 100 rad: far above what the normals' noise explains.
  PoseVector on_the_way = PoseVector::Zero();
  on_the_way[3] = 1.0;
  on_the_way[2] = 1.0 / 100.0;
  for (unsigned seed = 0; seed < 50; ++seed) {
    const View view = look(bent_tunnel(100.0), seed);
    ASSERT_LT(view.localizability.support[0], kSupported);
    EXPECT_FALSE(view.localizability.pure[0]);
    const PoseVector weak = unscaled_directions(view.localizability).col(0);
    EXPECT_NEAR(weak[2] / weak[3], 1.0 / 100.0, 0.001);
  }
}

TEST(Decouple, AStraightTunnelHasAPureAxis) {
  int pure = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const View view = look(bent_tunnel(1e6), seed);
    if (!view.localizability.pure[0]) continue;
    ++pure;
    EXPECT_EQ(view.localizability.directions.col(0).head<3>().norm(), 0.0);
    EXPECT_GT(std::abs(view.localizability.directions(3, 0)), 0.999);
  }
  EXPECT_GT(pure, 90);
}

TEST(Decouple, WhereEverythingIsSupportedNothingChanges) {
  Localizability l = judge_localizability(1e6 * PoseMatrix::Identity(), PoseMatrix::Identity(), 1.0, kFloor);
  const PoseMatrix before = l.directions;
  decouple(
      1e6 * PoseMatrix::Identity(), PoseMatrix::Identity(), [](const PoseVector&) { return PoseMatrix::Zero(); }, l);
  EXPECT_EQ(l.directions, before);
  EXPECT_EQ(pure_count(l), 0);
  EXPECT_EQ(without_pure(l), PoseMatrix(before * before.inverse()));
}

}  // namespace
}  // namespace allan_lio
