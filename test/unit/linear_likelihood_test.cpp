// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "allan_lio/calib/linear_trials.h"
#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/imu/discretize.h"
#include "allan_lio/lio/bias_mean.h"

namespace allan_lio {
namespace {

constexpr double kLog2Pi = 1.83787706640934548356;

Eigen::MatrixXd random_matrix(int rows, int cols, std::mt19937_64& bits) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd m(rows, cols);
  for (int i = 0; i < m.size(); ++i) m.data()[i] = normal(bits);
  return m;
}

Eigen::MatrixXd random_covariance(int dof, double scale, std::mt19937_64& bits) {
  const Eigen::MatrixXd root = random_matrix(dof, dof, bits);
  return scale * (root * root.transpose() + Eigen::MatrixXd::Identity(dof, dof));
}

/// Five scans without any sense, one of them without a registration.
LinearRun random_run(std::mt19937_64& bits) {
  LinearRun run;
  run.initial_covariance = random_covariance(kInertialDof, 0.1, bits);
  run.gyro_psd << 0.2, 0.3, 0.4;
  run.k_r = 2.0;
  for (int i = 0; i < 5; ++i) {
    LinearScan scan;
    scan.time = 10.0 + 0.1 * i;
    scan.step = 0.1;
    scan.phi = NavMatrix::Identity() + 0.1 * random_matrix(kNavDof, kNavDof, bits);
    for (NavMatrix& noise : scan.noise) noise = random_covariance(kNavDof, 0.05, bits);
    scan.bridged = random_covariance(kNavDof, 0.01, bits);
    scan.correction = 0.3 * random_matrix(kInertialDof, 1, bits);
    scan.view_noise = random_covariance(6, 0.2, bits);
    scan.view_kept = 0.7;
    scan.deskewed = 0.1;
    const int rows = i == 2 ? 0 : 2 + i % 3;
    scan.rows = random_matrix(rows, 6, bits);
    scan.map_rows = random_matrix(rows, 6, bits);
    scan.measured = random_matrix(rows, 1, bits);
    scan.variances = SupportedVector::Constant(rows, 0.5 + 0.1 * i);
    scan.log_gram = 0.1 * i;
    run.scans.push_back(scan);
  }
  return run;
}

/// What is random, one after the other, and the measurements as linear functions of it.
struct Stacked {
  Eigen::MatrixXd covariance;  ///< of what is random
  Eigen::MatrixXd map;         ///< to the measurements
  Eigen::VectorXd mean, measured;
};

/// All of a run's measurements at once, without a filter.
Stacked stack(const LinearRun& run, const NoiseSetting& setting, const LidarErrors& errors) {
  constexpr int kPerScan =
      kInertialDof + 6 + 6 + 6;  // w or the first error, view's and drift's steps, deskewing's error
  const int dof = kPerScan * static_cast<int>(run.scans.size());
  const double k[] = {setting.imu.k_g, setting.imu.k_a, setting.imu.k_gb, setting.imu.k_ab};
  Stacked out{Eigen::MatrixXd::Zero(dof + 100, dof + 100), Eigen::MatrixXd(0, dof + 100), {}, {}};
  int total = dof;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(kInertialDof, dof + 100), view = Eigen::MatrixXd::Zero(6, dof + 100),
                  drift = view;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kInertialDof);
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    const LinearScan& scan = run.scans[i];
    const int w = kPerScan * static_cast<int>(i), u = w + kInertialDof, d = u + 6, n = d + 6;
    if (i == 0) {
      out.covariance.block<kInertialDof, kInertialDof>(w, w) = run.initial_covariance;
    } else {
      NavMatrix q = scan.bridged;
      for (int part = 0; part < 4; ++part) q += k[part] * k[part] * scan.noise[static_cast<std::size_t>(part)];
      out.covariance.block<kNavDof, kNavDof>(w, w) = q;
      out.covariance.block<6, 6>(u, u) =
          (1.0 - scan.view_kept * scan.view_kept) * errors.view * errors.view * scan.view_noise;
      out.covariance.block<3, 3>(d, d).diagonal().setConstant(errors.drift_rotation * errors.drift_rotation *
                                                              scan.step);
      out.covariance.block<3, 3>(d + 3, d + 3)
          .diagonal()
          .setConstant(errors.drift_position * errors.drift_position * scan.step);
      x = (with_bias_means(scan.phi) * x).eval();
      mean = (with_bias_means(scan.phi) * mean).eval() - scan.correction;
      view *= scan.view_kept;
    }
    x.block(0, w, kInertialDof, kInertialDof) += Eigen::MatrixXd::Identity(kInertialDof, kInertialDof);
    view.block<6, 6>(0, u) += Eigen::MatrixXd::Identity(6, 6);
    drift.block<6, 6>(0, d) += Eigen::MatrixXd::Identity(6, 6);
    const Eigen::Vector3d density = k[0] * k[0] * scan.deskewed * run.gyro_psd;
    out.covariance.block<3, 3>(n, n).diagonal() = density / 3.0;
    out.covariance.block<3, 3>(w, n).diagonal() = density / 2.0;
    out.covariance.block<3, 3>(n, w).diagonal() = density / 2.0;
    const auto rows = scan.rows.rows();
    if (rows == 0) continue;
    Eigen::MatrixXd h = scan.rows * (x.topRows<6>() - view) - scan.map_rows * drift;
    h.middleCols(n, 6) -= scan.rows;
    const double white = errors.white * setting.k_r / run.k_r;
    for (Eigen::Index row = 0; row < rows; ++row, ++total) {
      h(row, total) = 1.0;
      out.covariance(total, total) = white * white * scan.variances[row];
    }
    const auto so_far = out.map.rows();
    out.map.conservativeResize(so_far + rows, Eigen::NoChange);
    out.map.bottomRows(rows) = h;
    out.mean.conservativeResize(so_far + rows);
    out.measured.conservativeResize(so_far + rows);
    out.mean.tail(rows) = scan.rows * mean.head<6>();
    out.measured.tail(rows) = scan.measured;
  }
  return out;
}

TEST(LinearLikelihood, IsTheDensityOfAllMeasurementsAtOnce) {
  std::mt19937_64 bits(5);
  const LinearRun run = random_run(bits);
  NoiseSetting setting;
  setting.imu = {1.3, 0.7, 2.0, 0.4};
  setting.k_r = 1.6;
  const LidarErrors errors{0.9, 1.7, 0.2, 0.3};
  const Stacked all = stack(run, setting, errors);
  const Eigen::LLT<Eigen::MatrixXd> root(all.map * all.covariance * all.map.transpose());
  ASSERT_EQ(root.info(), Eigen::Success);
  const double nis = root.matrixL().solve(all.measured - all.mean).squaredNorm();
  double log_det = 2.0 * root.matrixLLT().diagonal().array().log().sum();
  for (const LinearScan& scan : run.scans)
    if (scan.rows.rows() > 0) log_det += scan.log_gram;
  const auto dof = static_cast<double>(all.measured.size());

  const LinearScore score = score_linear(run, setting, errors);
  EXPECT_EQ(score.dof, static_cast<std::uint64_t>(all.measured.size()));
  EXPECT_NEAR(score.nis, nis, 1e-8 * nis);
  EXPECT_NEAR(score.nll, 0.5 * (nis + log_det + dof * kLog2Pi), 1e-8 * std::abs(score.nll));
  EXPECT_EQ(score_linear(run, setting, errors, false).nll, score.nll) << "horizons or not";
}

TEST(LinearLikelihood, WhileTheMapIsFoundedNothingCounts) {
  std::mt19937_64 bits(6);
  LinearRun run = random_run(bits);
  for (LinearScan& scan : run.scans) scan.time -= 10.0;
  const LinearScore score = score_linear(run, {}, {});
  EXPECT_EQ(score.dof, 0U);
  EXPECT_EQ(score.nll, 0.0);
}

// A vehicle at rest whose errors are drawn from the model itself.

constexpr double kStep = 0.1;         // [s]
constexpr double kGyroWhite = 1e-4;   // [rad/s/sqrt(Hz)]
constexpr double kAccelWhite = 1e-3;  // [m/s^2/sqrt(Hz)]
constexpr double kGyroWalk = 1e-5, kAccelWalk = 1e-4;

/// `bias_rate`: 1/T_b of Gauss-Markov biases about unknown constants [1/s]; 0: random walks.
LinearRun drawn_run(const NoiseSetting& truth, const LidarErrors& errors, int scans, unsigned seed,
                    double bias_rate = 0.0) {
  std::mt19937_64 bits(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](const auto& covariance) {
    const auto dof = covariance.rows();
    const Eigen::LDLT<Eigen::MatrixXd> root{Eigen::MatrixXd(covariance)};
    Eigen::VectorXd z(dof);
    for (Eigen::Index i = 0; i < dof; ++i) z[i] = normal(bits) * std::sqrt(std::max(0.0, root.vectorD()[i]));
    return Eigen::VectorXd(root.transpositionsP().transpose() * Eigen::VectorXd(root.matrixL() * z));
  };
  NavState rest;
  const ImuInterval interval{kStep, Eigen::Vector3d::Zero(), -rest.gravity_world};
  const double psd[] = {kGyroWhite * kGyroWhite, kAccelWhite * kAccelWhite, kGyroWalk * kGyroWalk,
                        kAccelWalk * kAccelWalk};
  const double k[] = {truth.imu.k_g, truth.imu.k_a, truth.imu.k_gb, truth.imu.k_ab};
  LinearRun run;
  run.initial_covariance = 1e-8 * InertialMatrix::Identity();
  run.initial_covariance.block<2, 2>(kGravity, kGravity) *= 1e-4;  // the tilt is the state's
  run.gyro_psd.setConstant(psd[0]);
  InertialVector x = InertialVector::Zero();
  x.head<kNavDof>() = draw(run.initial_covariance.topLeftCorner<kNavDof, kNavDof>());
  run.initial_covariance.bottomRightCorner<6, 6>().setZero();  // of random walks
  if (bias_rate > 0.0) {  // 1 sigma of the constants 0.01 rad/s and m/s^2, the biases near them
    constexpr double kConstant = 0.01;
    for (int i = 0; i < 6; ++i) {
      x[kGyroBiasMean + i] = kConstant * normal(bits);
      x[kGyroBias + i] += x[kGyroBiasMean + i];
      for (const int row : {kGyroBias + i, kGyroBiasMean + i})
        for (const int column : {kGyroBias + i, kGyroBiasMean + i})
          run.initial_covariance(row, column) += kConstant * kConstant;
    }
  }
  PoseVector view = PoseVector::Zero(), drift = PoseVector::Zero();
  for (int i = 0; i < scans; ++i) {
    LinearScan scan;
    scan.time = kStep * i;
    scan.step = kStep;
    NavMatrix q = NavMatrix::Zero();
    for (std::size_t part = 0; part < 4; ++part) {
      ImuNoise noise;
      noise.gyro_bias_rate.setConstant(bias_rate);
      noise.accel_bias_rate.setConstant(bias_rate);
      (part == 0   ? noise.gyro_psd
       : part == 1 ? noise.accel_psd
       : part == 2 ? noise.gyro_bias_psd
                   : noise.accel_bias_psd)
          .setConstant(psd[part]);
      const DiscreteModel model = discretize(rest, interval, noise, Discretization::kTrapezoid);
      scan.phi = model.phi;
      scan.noise[part] = model.q;
      q += k[part] * k[part] * model.q;
    }
    scan.view_kept = std::exp(-kStep / 2.0);
    scan.view_noise.setZero();
    scan.view_noise.diagonal().head<3>().setConstant(1e-9);
    scan.view_noise.diagonal().tail<3>().setConstant(1e-7);
    if (i > 0) {
      x = with_bias_means(scan.phi) * x;
      x.head<kNavDof>() += draw(q);
      view = scan.view_kept * view + errors.view * draw((1.0 - scan.view_kept * scan.view_kept) * scan.view_noise);
      for (int j = 0; j < 6; ++j)
        drift[j] += (j < 3 ? errors.drift_rotation : errors.drift_position) * std::sqrt(kStep) * normal(bits);
    }
    scan.rows = SupportedRows::Identity(6, 6);
    scan.map_rows = scan.rows;
    scan.variances.resize(6);
    scan.variances << 1e-9, 1e-9, 1e-9, 1e-7, 1e-7, 1e-7;
    scan.measured = x.head<6>() - view - drift;
    for (int j = 0; j < 6; ++j) scan.measured[j] += errors.white * std::sqrt(scan.variances[j]) * normal(bits);
    run.scans.push_back(scan);
  }
  return run;
}

std::vector<LinearisedTrial> as_trials(std::vector<LinearRun> runs) {
  std::vector<LinearisedTrial> trials;
  for (LinearRun& run : runs) {
    LinearisedTrial trial;
    trial.trial.bag = static_cast<std::uint32_t>(trials.size());
    trial.run = std::move(run);
    trials.push_back(std::move(trial));
  }
  return trials;
}

TEST(LinearLikelihood, WithTheTrueNoiseInnovationsAndHorizonsAreWhatIsExpected) {
  NoiseSetting truth;
  truth.imu = {2.0, 0.5, 3.0, 0.7};
  const LidarErrors errors{0.8, 1.5, 2e-5, 2e-4};
  const LinearRun run = drawn_run(truth, errors, 6000, 3);
  const LinearScore right = score_linear(run, truth, errors);
  EXPECT_NEAR(right.nis / static_cast<double>(right.dof), 1.0, 4.0 * std::sqrt(2.0 / static_cast<double>(right.dof)));
  // 600 s hold some 1500 independent components of horizons.
  EXPECT_NEAR(right.horizon.nis / right.horizon.dof, 1.0, 0.15);
  for (const double factor : {0.8, 1.25}) {
    for (double NoiseScale::*k : {&NoiseScale::k_g, &NoiseScale::k_a}) {
      NoiseSetting off = truth;
      off.imu.*k *= factor;
      const LinearScore other = score_linear(run, off, errors);
      EXPECT_GT(other.nll, right.nll);
      EXPECT_GT(other.horizon.nll, right.horizon.nll);
    }
  }
}

TEST(LinearLikelihood, OfBiasesInTwoPartsTooHorizonsAreWhatIsExpectedAndTellTheWandering) {
  NoiseSetting truth;
  truth.imu = {1.0, 1.0, 3.0, 3.0};
  const LidarErrors errors;
  const LinearRun run = drawn_run(truth, errors, 6000, 4, 0.05);
  const LinearScore right = score_linear(run, truth, errors);
  EXPECT_NEAR(right.nis / static_cast<double>(right.dof), 1.0, 4.0 * std::sqrt(2.0 / static_cast<double>(right.dof)));
  EXPECT_NEAR(right.horizon.nis / right.horizon.dof, 1.0, 0.15);
  for (const double factor : {0.5, 2.0}) {
    NoiseSetting off = truth;
    off.imu.k_gb *= factor;
    EXPECT_GT(score_linear(run, off, errors).horizon.nll, right.horizon.nll) << factor;
  }
}

TEST(LidarErrorFit, FindsTheNoiseThatTheRunsWereDrawnFrom) {
  NoiseSetting truth;
  truth.imu = {2.0, 0.5, 3.0, 1.5};
  const LidarErrors errors{0.8, 1.5, 3e-5, 3e-4};
  const auto runs = as_trials({drawn_run(truth, errors, 1000, 1), drawn_run(truth, errors, 1000, 2)});
  for (const double start : {0.1, 30.0}) {
    NoiseSetting at;
    at.imu = {start, start, start, start};
    LidarErrorStart begin;
    begin.setting = at;
    begin.with_deviations = true;
    const LidarErrorFit fit = fit_lidar_errors(runs, NoiseProblem(), begin, {2, nullptr});
    const double found[] = {fit.setting.imu.k_g, fit.setting.imu.k_a, fit.setting.imu.k_gb, fit.setting.imu.k_ab};
    const double right[] = {truth.imu.k_g, truth.imu.k_a, truth.imu.k_gb, truth.imu.k_ab};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_GT(fit.deviations[i], 0.0) << i;
      EXPECT_LT(fit.deviations[i], 0.5) << i;
      EXPECT_LT(std::abs(std::log(found[i] / right[i])), 3.5 * fit.deviations[i]) << i << " from " << start;
    }
    EXPECT_NEAR(fit.errors.white, errors.white, 0.05);
    EXPECT_NEAR(fit.errors.view, errors.view, 0.4);
  }
}

TEST(LidarErrorFit, OfRunsThatAllDivergedThereIsNone) {
  EXPECT_THROW(fit_lidar_errors(std::vector<LinearisedTrial>(2), NoiseProblem(), {}, {}), std::invalid_argument);
}

TEST(LinearTrials, AreJudgedOnTheRunOfTheirBagAndNumber) {
  NoiseSetting truth;
  auto runs = as_trials({drawn_run(truth, {}, 400, 1), drawn_run(truth, {}, 400, 2)});
  const LidarErrors errors;
  const LinearScore second = score_linear(runs[1].run, truth, errors);
  const TrialEngine engine =
      make_linear_trials(std::make_shared<std::vector<LinearisedTrial>>(runs), errors, {2, nullptr});
  const std::vector<TrialResult> results = engine({{1, truth, 0}, {0, truth, 0}}, {});
  EXPECT_EQ(results[0].nll, second.nll);
  EXPECT_EQ(results[0].horizon_nll, second.horizon.nll);
  EXPECT_NE(results[1].nll, second.nll);
  EXPECT_TRUE(std::isnan(results[0].ate)) << "a linear run knows no truth";
  EXPECT_THROW(engine({{2, truth, 0}}, {}), std::invalid_argument);
  EXPECT_THROW(engine({{1, truth, 1}}, {}), std::invalid_argument);
}

TEST(LinearTrials, ANoiseWithoutMeasureIsADivergedTrialWithAFiniteScore) {
  auto runs = as_trials({drawn_run({}, {}, 400, 1)});
  runs[0].run.scans[100].measured[0] = std::numeric_limits<double>::quiet_NaN();
  const auto engine = make_linear_trials(std::make_shared<std::vector<LinearisedTrial>>(runs), {}, {});
  const TrialResult result = engine({{0, {}, 0}}, {})[0];
  EXPECT_TRUE(result.diverged);
  EXPECT_EQ(result.nll, kWorstScanNll * 400.0);
  EXPECT_EQ(result.horizon_nll, kWorstScanNll * 400.0);
}

}  // namespace
}  // namespace allan_lio
