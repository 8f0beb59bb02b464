// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/iterated_update.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

#include "allan_lio/math/so3.h"
#include "central_differences.h"
#include "scene_points.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr double kRounding = 1e-9;

LioMatrix some_covariance(unsigned seed) {
  std::srand(seed);
  const LioMatrix a = LioMatrix::Random();
  return 0.01 * (a * a.transpose() + 0.1 * LioMatrix::Identity());
}

LioState state_at(const Eigen::Vector3d& turn, const Eigen::Vector3d& position) {
  LioState state;
  state.nav.T_world_imu = {exp_so3(turn), position};
  return state;
}

TEST(IteratedUpdate, StateMinusUndoesPlusAndTransportIsItsInverseJacobian) {
  LioState x = state_at({0.1, 0.2, -0.4}, {1, 2, 3});
  x.nav.gravity_world = exp_so3({0.05, -0.02, 0}) * Eigen::Vector3d(0, 0, -9.8);
  LioVector delta;
  std::srand(3);
  delta = 0.3 * LioVector::Random();
  const LioState y = lio_plus(x, delta);
  EXPECT_LT((lio_minus(y, x) - delta).norm(), kRounding);
  const LioMatrix forward = transport(y, x);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kLioDof; ++i) {
    const LioVector d = LioVector::Unit(i) * kStep;
    const LioVector column = (lio_minus(lio_plus(y, d), x) - lio_minus(lio_plus(y, -d), x)) / (2 * kStep);
    EXPECT_LT((forward * column - LioVector::Unit(i)).norm(), 1e-7) << "column " << i;
  }
}

TEST(IteratedUpdate, OneStepEqualsTheKalmanUpdateOfALinearProblem) {
  // Measurement of the pose, rows H, noise R: the textbook's gain form against the information form.
  const LioState prior = state_at({0, 0, 0}, {0, 0, 0});
  const LioMatrix p = some_covariance(1);
  std::srand(5);
  const Eigen::Matrix<double, 8, kResidualDof> rows = Eigen::Matrix<double, 8, kResidualDof>::Random();
  const Eigen::Matrix<double, 8, 1> z = 0.01 * Eigen::Matrix<double, 8, 1>::Random();
  const double variance = 0.02;
  NormalEquations equations;
  equations.information = rows.transpose() * rows / variance;
  equations.gradient = -rows.transpose() * z / variance;

  Eigen::Matrix<double, 8, kLioDof> h = Eigen::Matrix<double, 8, kLioDof>::Zero();
  h.leftCols<6>() = rows.leftCols<6>();
  h.rightCols<6>() = rows.rightCols<6>();
  const Eigen::Matrix<double, 8, 8> s = h * p * h.transpose() + variance * Eigen::Matrix<double, 8, 8>::Identity();
  const Eigen::Matrix<double, kLioDof, 8> gain = p * h.transpose() * s.inverse();
  const LioVector expected = -gain * z;
  const LioMatrix expected_covariance = p - gain * h * p;

  const UpdateStep once = solve_step(prior, prior, Belief{p, {}}, ScanError{}, equations);
  EXPECT_LT((once.step - expected).norm(), kRounding * expected.norm());
  EXPECT_LT((once.posterior.covariance - expected_covariance).norm(), kRounding * p.norm());
}

TEST(IteratedUpdate, MoreIterationsOfALinearProblemStayAtTheOneStepSolution) {
  // Positions only, so that the manifold is flat: a lost pull of the prior would move the second iteration.
  const LioState prior = state_at({0, 0, 0}, {1, 2, 3});
  const LioMatrix p = some_covariance(2);
  const Eigen::Vector3d target(1.4, 1.7, 3.3);
  const double variance = 0.05;
  const auto measure = [&](const LioState& x) {
    NormalEquations e;
    e.information.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity() / variance;
    e.gradient.segment<3>(3) = (target - x.nav.T_world_imu.translation) / variance;
    return e;
  };
  LioState iterate = prior;
  const LioVector first = solve_step(prior, prior, Belief{p, {}}, ScanError{}, measure(prior)).step;
  LioMatrix covariance;
  for (int i = 0; i < 5; ++i) {
    const UpdateStep step = solve_step(iterate, prior, Belief{p, {}}, ScanError{}, measure(iterate));
    iterate = lio_plus(iterate, step.step);
    covariance = step.posterior.covariance;
  }
  const LioState once = lio_plus(prior, first);
  EXPECT_LT((iterate.nav.T_world_imu.translation - once.nav.T_world_imu.translation).norm(), 1e-3)
      << "rotation couples in through the covariance, so the two differ by its second order only";
  EXPECT_LT((iterate.nav.velocity_world - once.nav.velocity_world).norm(), 1e-3);
}

TEST(IteratedUpdate, AStateWithoutUncertaintyStaysWhereItIs) {
  LioMatrix p = some_covariance(4);
  p.bottomRows<6>().setZero();
  p.rightCols<6>().setZero();
  NormalEquations e;
  e.information.setIdentity();
  e.gradient.setOnes();
  const LioState prior = state_at({0, 0, 0}, {0, 0, 0});
  const UpdateStep step = solve_step(prior, prior, Belief{p, {}}, ScanError{}, e);
  EXPECT_EQ(step.step.tail<6>().norm(), 0.0);
  EXPECT_EQ(step.posterior.covariance.bottomRows<6>().norm(), 0.0);
  EXPECT_TRUE(step.step.allFinite());
}

class RegisterToScene : public ::testing::Test {
 protected:
  LioConfig config_ = default_config(mti600_spec());
  TaskPool pool_{1};
  PointToPlane residuals_{pool_};

  /// Registers 4000 points seen from the true pose, starting from a wrong one.
  UpdateReport run(bool corridor, LioState& state, LioMatrix& p) {
    // The corridor goes on beyond what the scan sees: where a map ends, its edge looks like structure.
    const auto scene = [&](int count, unsigned seed, double stretch) {
      return corridor ? corridor_points(count, 0.02, seed, stretch) : room_points(count, 0.02, seed);
    };
    const auto map = make_plane_voxel_map({0.5, 0.02, 50.0, 100.0});
    map->insert(scene(90000, 1, 1.5), Eigen::Vector3d::Zero());
    const RigidTransform T_imu_world = truth_.T_world_imu.inverse();
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& q : scene(4000, 99, 1.0)) points.push_back((T_imu_world * q).cast<float>());
    Belief belief{p, {}};
    AbsoluteCovariance absolute;
    absolute.reset(p);
    const UpdateReport report =
        iterated_update(points, *map, config_, ScanConditions{0.1}, residuals_, state, belief, absolute);
    p = belief.covariance;
    return report;
  }

  NavState truth_ = state_at({0.02, -0.01, 0.03}, {0.10, -0.06, 0.04}).nav;
};

TEST_F(RegisterToScene, FindsThePoseInARoomToMillimetres) {
  LioState state;
  LioMatrix p = LioMatrix::Identity() * 0.01;
  const UpdateReport report = run(false, state, p);
  ASSERT_TRUE(report.applied);
  EXPECT_LT((state.nav.T_world_imu.translation - truth_.T_world_imu.translation).norm(), 3e-3);
  EXPECT_LT(log_so3(state.nav.T_world_imu.rotation.conjugate() * truth_.T_world_imu.rotation).norm(), 1e-3);
  EXPECT_GT(report.localizability.support.minCoeff(), 0.9);
  // The prior knows 0.1 rad and 0.1 m, of which leaning normals feign some millimetres (ResidualNoise::kLooks).
  EXPECT_LT(p(kPosition, kPosition), 1e-4);
  p = LioMatrix::Identity() * 1e-6;
  run(false, state, p);
  EXPECT_LT(p(kPosition, kPosition), 1e-6) << "they feign nothing of a pose that is known";
}

TEST_F(RegisterToScene, LeavesTheAxisOfACorridorToThePrior) {
  LioState state;
  LioMatrix p = LioMatrix::Identity() * 0.01;
  const UpdateReport report = run(true, state, p);
  ASSERT_TRUE(report.applied);
  EXPECT_NEAR(state.nav.T_world_imu.translation.x(), 0.0, 0.01) << "nothing tells of x, so it stays";
  EXPECT_NEAR(p(kPosition, kPosition), 0.01, 1e-3) << "and its uncertainty too";
  EXPECT_NEAR(state.nav.T_world_imu.translation.y(), truth_.T_world_imu.translation.y(), 0.01);
  EXPECT_LT(p(kPosition + 1, kPosition + 1), 1e-4);
  EXPECT_LT(report.localizability.support.minCoeff(), 0.1);
  EXPECT_GT(report.localizability.support.maxCoeff(), 0.9);
}

TEST_F(RegisterToScene, ScansWithoutMatchesLeaveStateAndCovarianceAlone) {
  LioState state = state_at({0, 0, 0}, {500, 500, 0});
  LioMatrix p = LioMatrix::Identity() * 0.01;
  const UpdateReport report = run(false, state, p);
  EXPECT_FALSE(report.applied);
  EXPECT_EQ(state.nav.T_world_imu.translation.x(), 500.0);
  EXPECT_EQ(p, LioMatrix(LioMatrix::Identity() * 0.01));
}

/// A map that is lost after so many look-ups.
class FleetingMap : public VoxelMap {
 public:
  explicit FleetingMap(int finds) : left_(finds) {
    plane_.center = {0, 0, 0};
    plane_.normal = {0, 0, 1};
    plane_.lean_1 = {1e-3, 0, 0};
    plane_.lean_2 = {0, 1e-3, 0};
    plane_.thickness = 4e-4;
    plane_.center_variance = 4e-6;
  }
  void insert(const std::vector<Eigen::Vector3d>&, const Eigen::Vector3d&, std::uint32_t) override {}
  const Plane* find(const Eigen::Vector3d&, Plane&) const override { return left_-- > 0 ? &plane_ : nullptr; }
  void clear() override {}
  std::size_t voxels() const override { return 1; }
  std::size_t bytes() const override { return 0; }
  std::vector<Eigen::Vector3d> points() const override { return {}; }

 private:
  Plane plane_;
  mutable int left_;
};

TEST_F(RegisterToScene, AnUpdateThatLosesItsMatchesOnTheWayChangesNothing) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 100; ++i)
    points.push_back({0.1F * static_cast<float>(i % 10), 0.1F * static_cast<float>(i / 10), 0.05F});
  const FleetingMap map(100);  // the first iteration's
  LioState state;
  Belief belief{0.01 * LioMatrix::Identity(), {}};
  belief.view.own = 1e-6 * PoseMatrix::Identity();
  AbsoluteCovariance absolute;
  absolute.reset(belief.covariance);
  const Belief before = belief;
  EXPECT_FALSE(iterated_update(points, map, config_, ScanConditions{0.1}, residuals_, state, belief, absolute).applied);
  EXPECT_EQ(belief.covariance, before.covariance);
  EXPECT_EQ(belief.view.cross, before.view.cross);
  EXPECT_EQ(belief.view.own, before.view.own);
  EXPECT_EQ(absolute.state(), before.covariance);
  EXPECT_EQ(state.nav.T_world_imu.translation, Eigen::Vector3d::Zero());
}

/// Flat ground whose planes lean by their noise, a plane a square of half a metre.
class NoisyGround : public VoxelMap {
 public:
  static constexpr double kLean = 0.05;  ///< [rad]

  void insert(const std::vector<Eigen::Vector3d>&, const Eigen::Vector3d&, std::uint32_t) override {}
  const Plane* find(const Eigen::Vector3d& point, Plane& scratch) const override {
    const int x = static_cast<int>(std::floor(2.0 * point.x())), y = static_cast<int>(std::floor(2.0 * point.y()));
    std::mt19937 random(static_cast<unsigned>(1000 * (x + 500) + y + 500));
    std::normal_distribution<double> lean(0.0, kLean);
    const double a = lean(random), b = lean(random);
    scratch.normal = Eigen::Vector3d(a, b, 1.0).normalized();
    scratch.center = {0.5 * x + 0.25, 0.5 * y + 0.25, -1.6};
    scratch.lean_1 = {kLean, 0, 0};
    scratch.lean_2 = {0, kLean, 0};
    scratch.thickness = 4e-4;
    scratch.center_variance = 4e-6;
    scratch.group = static_cast<std::uint32_t>(200 * (x + 100) + y + 100);
    return &scratch;
  }
  void clear() override {}
  std::size_t voxels() const override { return 1; }
  std::size_t bytes() const override { return 0; }
  std::vector<Eigen::Vector3d> points() const override { return {}; }
};

TEST_F(RegisterToScene, FlatGroundSaysNothingOfThePositionAlongItThroughTiltAndHeightEither) {
  // Tilt and height are known well, so a normal's noise would turn their agreement into a measurement of x and y.
  LioMatrix p = 1e-12 * LioMatrix::Identity();
  p.block<3, 3>(kTheta, kTheta) = 4e-7 * Eigen::Matrix3d::Identity();
  p.block<3, 3>(kPosition, kPosition) = Eigen::Vector3d(0.04, 0.04, 1e-4).asDiagonal();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-12.0, 12.0);
  std::normal_distribution<double> noise(0.0, 0.02);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 300; ++i)
    points.push_back(Eigen::Vector3d(place(random), place(random), noise(random) - 1.6).cast<float>());
  LioState state;
  Belief belief{p, {}};
  AbsoluteCovariance absolute;
  absolute.reset(p);
  ASSERT_TRUE(iterated_update(points, NoisyGround(), config_, ScanConditions{0.1}, residuals_, state, belief, absolute)
                  .applied);
  constexpr double kLeastLeft = 0.98;  // of the variance
  EXPECT_GT(belief.covariance(kPosition, kPosition), kLeastLeft * 0.04);
  EXPECT_GT(belief.covariance(kPosition + 1, kPosition + 1), kLeastLeft * 0.04);
  EXPECT_LT(state.nav.T_world_imu.translation.head<2>().norm(), 0.02);
}

}  // namespace
}  // namespace allan_lio
