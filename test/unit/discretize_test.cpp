// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/discretize.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

#include "allan_lio/imu/propagate.h"
#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"
#include "central_differences.h"

namespace allan_lio {
namespace {

constexpr double kStep = 1e-3;
constexpr double kDifference = 1e-9;  // what central differences of fourth order with kStep are good for

const std::vector<StateBlock> kBlocks = {{"theta", kTheta, 3},          {"position", kPosition, 3},
                                         {"velocity", kVelocity, 3},    {"gyro bias", kGyroBias, 3},
                                         {"accel bias", kAccelBias, 3}, {"gravity", kGravity, 2}};

const std::vector<Discretization> kMethods = {Discretization::kEuler, Discretization::kTrapezoid,
                                              Discretization::kDiscrete, Discretization::kVanLoan};

NavState start() {
  NavState x;
  x.T_world_imu = {exp_so3({0.4, -1.1, 2.0}), {10, -3, 2}};
  x.velocity_world << 1, 2, -0.5;
  x.gyro_bias << 0.01, -0.02, 0.003;
  x.accel_bias << -0.1, 0.05, 0.2;
  x.gravity_world = 9.8 * Eigen::Vector3d(0.02, -0.01, -1.0).normalized();
  return x;
}

ImuInterval interval(double dt) {
  ImuInterval result;
  result.dt = dt;
  result.gyro << 0.5, -2.0, 1.0;
  result.accel << 1, -2, 9;
  return result;
}

/// Different on every axis, so that a rotation of it shows.
ImuNoise noise(BiasModel model) {
  ImuNoise n;
  n.gyro_psd << 1.0, 2.0, 0.5;
  n.accel_psd << 3.0, 1.0, 2.0;
  n.gyro_bias_psd << 0.2, 0.4, 0.3;
  n.accel_bias_psd << 0.5, 0.1, 0.3;
  if (model == BiasModel::kGaussMarkov) {
    n.gyro_bias_rate << 0.1, 0.05, 0.2;
    n.accel_bias_rate << 0.05, 0.1, 0.02;
  }
  return n;
}

double largest(const NavMatrix& m) { return m.cwiseAbs().maxCoeff(); }

/// Covariance after 1 s of constant rate and specific force from P = 0, by steps at `rate` [Hz].
NavMatrix covariance_after_a_second(Discretization method, int rate, const ImuNoise& n) {
  NavState x = start();
  NavMatrix p = NavMatrix::Zero();
  const ImuInterval step = interval(1.0 / rate);
  for (int i = 0; i < rate; ++i) {
    const DiscreteModel model = discretize(x, step, n, method);
    p = model.phi * p * model.phi.transpose() + model.q;
    x = propagate_mean(x, step, n);
  }
  return p;
}

TEST(Discretize, PhiAgreesWithCentralDifferencesOfTheMean) {
  for (const double dt : {0.0025, 0.01, 0.1, 0.5}) {
    const NavState x = start();
    ImuSample from, to;  // readings whose mean less the biases is interval(dt)
    to.stamp = to_ns(dt);
    from.gyro = to.gyro = interval(dt).gyro + x.gyro_bias;
    from.accel = to.accel = interval(dt).accel + x.accel_bias;
    const ImuNoise walk = noise(BiasModel::kRandomWalk);
    const auto move = [&](const NavState& s) { return propagate_mean(s, mean_interval(s, from, to), walk); };
    const NavState mean = move(x);
    const Eigen::MatrixXd numeric = central_differences(
        [&](const Eigen::VectorXd& d) { return nav_minus(move(nav_plus(x, NavVector(d))), mean); }, kNavDof, kStep);
    const NavMatrix phi = discretize(x, interval(dt), walk, Discretization::kTrapezoid).phi;
    EXPECT_EQ(differing_blocks(phi, numeric, kBlocks, kDifference), "") << "dt " << dt;
  }
}

TEST(Discretize, AllMethodsShareThePhiOfVanLoan) {
  constexpr double kExponential = 1e-11;
  for (const double dt : {0.0025, 0.01, 0.1, 0.5}) {
    const ImuNoise walk = noise(BiasModel::kRandomWalk);
    const NavMatrix reference = discretize(start(), interval(dt), walk, Discretization::kVanLoan).phi;
    for (const Discretization method : kMethods)
      EXPECT_EQ(differing_blocks(discretize(start(), interval(dt), walk, method).phi, reference, kBlocks, kExponential),
                "")
          << "dt " << dt << ", method " << static_cast<int>(method);
  }
}

TEST(Discretize, TheDecayNeglectedInPhiIsOfSecondOrderInDtOverT) {
  const ImuNoise markov = noise(BiasModel::kGaussMarkov);
  for (const double dt : {0.0025, 0.005, 0.01}) {
    const NavMatrix reference = discretize(start(), interval(dt), markov, Discretization::kVanLoan).phi;
    const NavMatrix phi = discretize(start(), interval(dt), markov, Discretization::kTrapezoid).phi;
    // A bias of 1 turns the attitude by dt; with decay by dt (1 - dt/2T). The shortest T is 5 s.
    EXPECT_EQ(differing_blocks(phi, reference, kBlocks, 1.01 * 0.5 * dt * dt / 5.0), "") << "dt " << dt;
    const auto bias = [](const NavMatrix& m) { return Eigen::MatrixXd(m.block<6, 6>(kGyroBias, kGyroBias)); };
    EXPECT_LT((bias(phi) - bias(reference)).cwiseAbs().maxCoeff(), 1e-14) << "the bias's own decay is exact";
  }
}

TEST(Discretize, EulerAndDiscreteAgreeToRounding) {
  for (const double dt : {0.001, 0.0025, 0.1}) {
    const ImuNoise n = noise(BiasModel::kRandomWalk);
    const NavMatrix euler = discretize(start(), interval(dt), n, Discretization::kEuler).q;
    const NavMatrix discrete = discretize(start(), interval(dt), n, Discretization::kDiscrete).q;
    EXPECT_LT(largest(euler - discrete), 1e-15 * largest(euler));
    EXPECT_GT(largest(euler), 0.0);
  }
}

TEST(Discretize, TheErrorOfAStepFallsWithDtSquaredForEulerAndCubedForTrapezoid) {
  const ImuNoise n = noise(BiasModel::kGaussMarkov);
  const auto error = [&](Discretization method, double dt) {
    return largest(discretize(start(), interval(dt), n, method).q -
                   discretize(start(), interval(dt), n, Discretization::kVanLoan).q);
  };
  constexpr double kOrder = 0.1;
  for (const double dt : {0.01, 0.005, 0.0025}) {
    const auto order = [&](Discretization method) { return std::log2(error(method, dt) / error(method, dt / 2)); };
    EXPECT_NEAR(order(Discretization::kEuler), 2.0, kOrder) << "dt " << dt;
    EXPECT_NEAR(order(Discretization::kDiscrete), 2.0, kOrder) << "dt " << dt;
    EXPECT_NEAR(order(Discretization::kTrapezoid), 3.0, kOrder) << "dt " << dt;
    EXPECT_LT(error(Discretization::kTrapezoid, dt), 0.1 * error(Discretization::kEuler, dt)) << "dt " << dt;
  }
}

TEST(Discretize, VanLoanAgreesWithFineQuadratureOfItsIntegral) {
  // Q = int_0^dt Phi(dt, s) G S G^T Phi(dt, s)^T ds, each slice by the midpoint and kEuler's G S G^T.
  const double dt = 0.2;
  const ImuNoise n = noise(BiasModel::kRandomWalk);
  constexpr int kSlices = 2000;
  NavMatrix sum = NavMatrix::Zero();
  for (int i = 0; i < kSlices; ++i) {
    const double s = (i + 0.5) * dt / kSlices;
    const NavState middle = propagate_mean(start(), interval(s), n);
    const NavMatrix density = discretize(middle, interval(1.0), n, Discretization::kEuler).q;
    const NavMatrix phi = discretize(middle, interval(dt - s), n, Discretization::kEuler).phi;
    sum += dt / kSlices * phi * density * phi.transpose();
  }
  const NavMatrix q = discretize(start(), interval(dt), n, Discretization::kVanLoan).q;
  EXPECT_EQ(differing_blocks(q, sum, kBlocks, 1e-6), "");
  EXPECT_GT(largest(q), 0.1);
}

TEST(Discretize, QIsSymmetricAndHasNoNegativeEigenvalue) {
  for (const BiasModel model : {BiasModel::kRandomWalk, BiasModel::kGaussMarkov})
    for (const Discretization method : kMethods)
      for (const double dt : {0.0005, 0.0025, 0.1}) {
        const NavMatrix q = discretize(start(), interval(dt), noise(model), method).q;
        EXPECT_LT(largest(q - q.transpose()), 1e-15 * largest(q));
        const Eigen::SelfAdjointEigenSolver<NavMatrix> eigen(q);
        EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-14 * largest(q)) << static_cast<int>(method) << ", dt " << dt;
      }
}

TEST(Discretize, WithoutNoiseThereIsNoQ) {
  for (const Discretization method : kMethods)
    EXPECT_EQ(largest(discretize(start(), interval(0.01), ImuNoise{}, method).q), 0.0);
}

TEST(Discretize, TheCovarianceAfterASecondDoesNotDependOnTheImusRate) {
  const ImuNoise n = noise(BiasModel::kGaussMarkov);
  for (const Discretization method : kMethods) {
    // The first-order methods are off by a few dt in position: that is what the trapezoid is for.
    const bool first_order = method == Discretization::kEuler || method == Discretization::kDiscrete;
    const double tolerance = first_order ? 0.03 : 0.01;
    const NavMatrix reference = covariance_after_a_second(Discretization::kVanLoan, 800, n);
    for (const int rate : {100, 200, 400}) {
      const NavMatrix p = covariance_after_a_second(method, rate, n);
      for (int i = 0; i < kGravity; ++i)
        EXPECT_NEAR(p(i, i) / reference(i, i), 1.0, tolerance)
            << "entry " << i << ", method " << static_cast<int>(method) << " at " << rate << " Hz";
    }
  }
}

TEST(Discretize, CovariancesOfSingleSamplesMeanFourTimesTheNoiseAtAQuarterOfTheRate) {
  // FAST-LIO2's convention: the configuration holds Q_d, the same numbers whatever the rate.
  const auto after_a_second = [](int rate) {
    const SensorNoise sensor = from_discrete({Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(1e-4)}, rate);
    const ImuNoise n = make_imu_noise({sensor, sensor}, NoiseScale{}, BiasModel::kRandomWalk);
    return covariance_after_a_second(Discretization::kDiscrete, rate, n);
  };
  const NavMatrix slow = after_a_second(100), fast = after_a_second(400);
  constexpr double kFirstOrder = 0.03;  // of that form of Q at 100 Hz
  for (int i = 0; i < kGravity; ++i) EXPECT_NEAR(slow(i, i) / fast(i, i) / 4.0, 1.0, kFirstOrder) << "entry " << i;
}

TEST(Discretize, TheCovarianceAfterASecondIsThatOfAMonteCarlo) {
  constexpr int kRuns = 2000, kRate = 200;
  constexpr double kSigmas = 4.0;  // of the chi-square statistics below
  ImuNoise n = noise(BiasModel::kGaussMarkov);
  n.gyro_psd *= 1e-5;  // errors small enough for the error state to be linear
  n.accel_psd *= 1e-3;
  n.gyro_bias_psd *= 1e-4;
  n.accel_bias_psd *= 1e-2;
  const NavMatrix p = covariance_after_a_second(Discretization::kTrapezoid, kRate, n);
  const double dt = 1.0 / kRate;
  NavState truth = start();
  truth.gyro_bias.setZero();
  truth.accel_bias.setZero();
  const NavState begin = truth;
  for (int i = 0; i < kRate; ++i) truth = propagate_mean(truth, interval(dt), n);

  std::mt19937_64 random(20260101);
  std::normal_distribution<double> normal;
  // Held over a step of dt, white noise of density s has variance s/dt; a bias grows by s dt.
  const auto draw = [&](const Eigen::Vector3d& variance) {
    return Eigen::Vector3d(std::sqrt(variance.x()) * normal(random), std::sqrt(variance.y()) * normal(random),
                           std::sqrt(variance.z()) * normal(random));
  };
  Eigen::Matrix<double, kGravity, 1> squares = Eigen::Matrix<double, kGravity, 1>::Zero();
  double nees = 0.0;
  const Eigen::LLT<Eigen::Matrix<double, kGravity, kGravity>> factor(p.topLeftCorner<kGravity, kGravity>());
  for (int run = 0; run < kRuns; ++run) {
    // The world goes its way; the estimate believes the readings. Its biases stay zero, the true ones wander.
    NavState estimate = begin;
    Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero(), accel_bias = Eigen::Vector3d::Zero();
    for (int i = 0; i < kRate; ++i) {
      ImuInterval reading = interval(dt);
      reading.gyro += gyro_bias + draw(n.gyro_psd / dt);
      reading.accel += accel_bias + draw(n.accel_psd / dt);
      estimate = propagate_mean(estimate, reading, n);
      gyro_bias =
          gyro_bias.cwiseProduct(Eigen::Vector3d((-dt * n.gyro_bias_rate).array().exp())) + draw(dt * n.gyro_bias_psd);
      accel_bias = accel_bias.cwiseProduct(Eigen::Vector3d((-dt * n.accel_bias_rate).array().exp())) +
                   draw(dt * n.accel_bias_psd);
    }
    NavState end = truth;
    end.gyro_bias = gyro_bias;
    end.accel_bias = accel_bias;
    const Eigen::Matrix<double, kGravity, 1> error = nav_minus(end, estimate).head<kGravity>();
    squares += error.cwiseAbs2();
    nees += error.dot(factor.solve(error));
  }
  for (int i = 0; i < kGravity; ++i)  // sum of squares / p ~ chi-square with kRuns degrees of freedom
    EXPECT_NEAR(squares[i] / p(i, i) / kRuns, 1.0, kSigmas * std::sqrt(2.0 / kRuns)) << "entry " << i;
  EXPECT_NEAR(nees / kRuns, kGravity, kSigmas * std::sqrt(2.0 * kGravity / kRuns));
}

TEST(Discretize, AGaussMarkovBiasSettlesAtItsSteadyVariance) {
  const ImuNoise n = noise(BiasModel::kGaussMarkov);
  const double dt = 0.005;
  for (const Discretization method : kMethods) {
    const DiscreteModel model = discretize(start(), interval(dt), n, method);
    Eigen::Matrix<double, 6, 6> p = Eigen::Matrix<double, 6, 6>::Zero();
    const Eigen::Matrix<double, 6, 6> phi = model.phi.block<6, 6>(kGyroBias, kGyroBias);
    const Eigen::Matrix<double, 6, 6> q = model.q.block<6, 6>(kGyroBias, kGyroBias);
    for (int i = 0; i < 400 / dt; ++i) p = phi * p * phi.transpose() + q;  // 8 of the longest T
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(p(axis, axis) / (0.5 * n.gyro_bias_psd[axis] / n.gyro_bias_rate[axis]), 1.0, 0.002);
      EXPECT_NEAR(p(axis + 3, axis + 3) / (0.5 * n.accel_bias_psd[axis] / n.accel_bias_rate[axis]), 1.0, 0.002);
    }
  }
}

}  // namespace
}  // namespace allan_lio
