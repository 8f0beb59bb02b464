// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/consistency.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <fstream>
#include <random>

#include "allan_lio/eval/consistency_report.h"
#include "allan_lio/eval/dead_reckoning.h"
#include "allan_lio/imu/discretize.h"
#include "allan_lio/imu/observable_error.h"
#include "allan_lio/math/so3.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1'600'000'000 * kNsPerSecond, kScan = kNsPerSecond / 10;
constexpr int kScans = 400;

NavVector sigmas() {
  NavVector sigma;
  sigma << 1e-4, 1e-4, 1e-4, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01, 1e-5, 1e-5, 1e-5, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3;
  return sigma;
}

/// A covariance with correlations between all blocks.
NavMatrix correlated_covariance() {
  std::mt19937 generator(7);
  std::normal_distribution<double> normal;
  NavMatrix mix;
  for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = normal(generator) / std::sqrt(double{kNavDof});
  const NavMatrix factor = sigmas().asDiagonal() * (NavMatrix::Identity() + 0.5 * mix);
  return factor * factor.transpose();
}

NavState true_state(int i) {
  NavState x;
  const double t = 0.1 * i;
  x.stamp = kStart + i * kScan;
  x.T_world_imu.rotation = exp_so3({0.02 * std::sin(t), 0.01, 0.3 * t});
  x.T_world_imu.translation << 1.2 * t, 3.0 * std::sin(0.2 * t), 0.0;
  x.velocity_world << 1.2, 0.6 * std::cos(0.2 * t), 0.0;
  x.gyro_bias << 1e-3, -2e-3, 3e-3;
  x.accel_bias << 0.01, 0.02, 0.03;
  return x;
}

/// A run whose errors are drawn from `covariance` times `scale`^2; the first pose is exact.
struct SyntheticRun {
  Trajectory truth;
  std::vector<TruthState> truth_states;
  StateRecord states;
};

SyntheticRun make_run(unsigned seed, double scale, const NavMatrix& covariance) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const NavMatrix factor = covariance.llt().matrixL();
  SyntheticRun run;
  for (int i = 0; i < kScans; ++i) {
    NavVector unit;
    for (int k = 0; k < kNavDof; ++k) unit[k] = normal(generator);
    NavVector error = scale * (factor * unit);
    if (i == 0) error.setZero();
    const NavState truth = true_state(i);
    StateRow row;
    row.nav = nav_plus(truth, -error);
    row.nav.stamp = truth.stamp;
    row.cov_theta = covariance.block<3, 3>(kTheta, kTheta);
    row.cov_position = covariance.block<3, 3>(kPosition, kPosition);
    row.cov_gyro_bias = covariance.block<3, 3>(kGyroBias, kGyroBias);
    row.cov_accel_bias = covariance.block<3, 3>(kAccelBias, kAccelBias);
    row.cov_tilt = tilt_covariance(row.nav, covariance);
    row.cov_imu_velocity = imu_velocity_covariance(row.nav, covariance);
    run.states.rows.push_back(row);
    run.truth.push_back({truth.stamp, truth.T_world_imu});
    run.truth_states.push_back({truth.stamp, truth.velocity_world, truth.gyro_bias, truth.accel_bias});
  }
  return run;
}

ConsistencySeries series_of(const SyntheticRun& run, const std::string& axis = "path") {
  return consistency_series(run.truth, run.truth_states, run.states, {parse_axis(axis), 0.5});
}

ConsistencySummary summary_over(int seeds, double scale) {
  const NavMatrix covariance = correlated_covariance();
  std::vector<ConsistencySeries> runs;
  for (int seed = 0; seed < seeds; ++seed) runs.push_back(series_of(make_run(seed, scale, covariance)));
  return summarize_consistency(runs);
}

const NeesSummary& nees(const ConsistencySummary& summary, NeesBlock block) {
  return summary.nees[static_cast<std::size_t>(block)];
}

constexpr NeesBlock kStateBlocks[] = {NeesBlock::kTilt,      NeesBlock::kVelocity, NeesBlock::kGyroBias,
                                      NeesBlock::kAccelBias, NeesBlock::kAlong,    NeesBlock::kAcross};

TEST(Consistency, ErrorsDrawnFromTheCovarianceLieInTheBandAtNineteenTimesInTwenty) {
  const ConsistencySummary summary = summary_over(20, 1.0);
  EXPECT_EQ(summary.runs, 20U);
  EXPECT_EQ(summary.times, static_cast<std::size_t>(kScans));
  for (const NeesBlock block : kStateBlocks) {
    EXPECT_NEAR(nees(summary, block).mean, 1.0, 0.05) << nees_block_name(block);
    EXPECT_NEAR(nees(summary, block).inside, 0.95, 0.05) << nees_block_name(block);
  }
  EXPECT_NEAR(summary.three_sigma_share, 0.997, 0.003);
}

TEST(Consistency, AFilterThatIsTwiceTooSureOrTooCautiousLeavesTheBand) {
  const ConsistencySummary sure = summary_over(20, 2.0), cautious = summary_over(20, 0.5);
  for (const NeesBlock block : kStateBlocks) {
    EXPECT_GT(nees(sure, block).mean, nees(sure, block).high) << nees_block_name(block);
    EXPECT_LT(nees(cautious, block).mean, nees(cautious, block).low) << nees_block_name(block);
    EXPECT_LT(nees(sure, block).inside, 0.5) << nees_block_name(block);
  }
  EXPECT_LT(sure.three_sigma_share, 0.95);
}

TEST(Consistency, TheBandIsThatOfSoManyRuns) {
  const NeesSummary one = nees(summary_over(1, 1.0), NeesBlock::kVelocity);
  EXPECT_NEAR(one.low, 0.2158 / 3, 1e-4);  // chi^2 of 3 degrees of freedom, tables
  EXPECT_NEAR(one.high, 9.3484 / 3, 1e-4);
  const NeesSummary ten = nees(summary_over(10, 1.0), NeesBlock::kVelocity);
  EXPECT_NEAR(ten.low, 16.791 / 30, 1e-4);
  EXPECT_NEAR(ten.high, 46.979 / 30, 1e-4);
}

TEST(Consistency, AnotherHeadingTiltAndOriginOfTheTruthChangeNothingButWhatDependsOnLevel) {
  SyntheticRun run = make_run(1, 1.0, correlated_covariance());
  const ConsistencySeries before = series_of(run);
  const RigidTransform other{exp_so3({0, 0, 2.0}), {100, -50, 3}};
  for (StampedPose& pose : run.truth) pose.pose = other * pose.pose;
  for (TruthState& state : run.truth_states) state.velocity_world = other.rotation * state.velocity_world;
  const ConsistencySeries after = series_of(run);
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 1; i < before.size(); ++i)
    for (std::size_t b = 0; b < kNeesBlocks; ++b) {
      if (std::isnan(before[i].nees[b])) continue;
      EXPECT_NEAR(after[i].nees[b], before[i].nees[b], 1e-6 * (1 + before[i].nees[b])) << i << " " << b;
    }
}

TEST(Consistency, AHeadingThatDriftsIsNoErrorOfTiltOrVelocity) {
  SyntheticRun run = make_run(1, 0.0, correlated_covariance());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()));
  for (std::size_t i = 1; i < run.states.rows.size(); ++i) {
    NavState& nav = run.states.rows[i].nav;
    nav.T_world_imu.rotation = turn * nav.T_world_imu.rotation;
    nav.velocity_world = turn * nav.velocity_world;
  }
  for (const ConsistencySample& sample : series_of(run)) {
    EXPECT_LT(sample.tilt.norm(), 1e-9);
    EXPECT_LT(sample.velocity.norm(), 1e-9);
  }
}

TEST(Consistency, ARelativePoseIsJudgedOverTenMetresByTheSumOfTheTwoCovariances) {
  NavMatrix covariance = NavMatrix::Zero();
  covariance.diagonal() = sigmas().cwiseAbs2();
  covariance.block<3, 3>(kTheta, kTheta).setIdentity();
  covariance.block<3, 3>(kTheta, kTheta) *= 1e-12;  // no lever
  std::vector<ConsistencySeries> runs;
  for (unsigned seed = 0; seed < 20; ++seed) runs.push_back(series_of(make_run(seed, 1.0, covariance)));
  const ConsistencySummary summary = summarize_consistency(runs);
  EXPECT_NEAR(nees(summary, NeesBlock::kRelativePosition).mean, 1.0, 0.05);
  EXPECT_NEAR(nees(summary, NeesBlock::kRelativeRotation).mean, 1.0, 0.05);
  EXPECT_TRUE(std::isnan(runs[0].back().nees[static_cast<std::size_t>(NeesBlock::kRelativePosition)]))
      << "no 10 m lie ahead of the last scan";
}

TEST(Consistency, TheAxialErrorIsTakenAlongTheAxisThatWasChosen) {
  SyntheticRun run = make_run(1, 0.0, correlated_covariance());
  for (std::size_t i = 1; i < run.states.rows.size(); ++i) run.states.rows[i].nav.T_world_imu.translation.z() -= 0.5;
  EXPECT_NEAR(series_of(run, "0,0,2").back().along, 0.5, 1e-9);
  EXPECT_NEAR(series_of(run, "path").back().along, 0.0, 1e-9);
  EXPECT_NEAR(series_of(run, "motion").back().along, 0.0, 1e-9);
  for (StateRow& row : run.states.rows) row.cov_position = Eigen::Vector3d(1e-4, 1e-4, 1.0).asDiagonal();
  EXPECT_NEAR(std::abs(series_of(run, "weakest").back().along), 0.5, 1e-9);
  for (const char* bad : {"", "1,2", "1,2,3,4", "0,0,0", "paths", "1,a,2"})
    EXPECT_THROW(parse_axis(bad), std::invalid_argument) << bad;
}

TEST(Consistency, WithoutTruthOfVelocityAndBiasesTheVelocityIsDifferentiatedAndTheBiasesAreNotJudged) {
  SyntheticRun run = make_run(1, 0.0, correlated_covariance());
  run.truth_states.clear();
  run.truth.clear();
  for (int k = 0; k < 20 * kScans; ++k) {  // at 200 Hz
    StampedPose pose;
    pose.stamp = kStart + k * (kScan / 20);
    pose.pose = true_state(0).T_world_imu;
    pose.pose.translation.y() = 3.0 * std::sin(0.2 * 0.005 * k);
    pose.pose.translation.x() = 1.2 * 0.005 * k;
    run.truth.push_back(pose);
  }
  for (StateRow& row : run.states.rows) row.nav.T_world_imu.rotation = true_state(0).T_world_imu.rotation;
  const ConsistencySeries series = series_of(run);
  for (std::size_t i = 1; i + 1 < series.size(); ++i) EXPECT_LT(series[i].velocity.norm(), 1e-5) << i;
  const ConsistencySummary summary = summarize_consistency({series});
  EXPECT_EQ(nees(summary, NeesBlock::kGyroBias).samples, 0U);
  EXPECT_NE(consistency_table(summary).find("gyro_bias          not recorded"), std::string::npos);
  EXPECT_NE(consistency_json(summary).find("\"gyro_bias\": null"), std::string::npos);
}

TEST(Consistency, TheCovariancesOfTiltAndVelocityAreThoseOfTheirErrors) {
  constexpr double kStep = 1e-6;
  const NavState estimate = nav_plus(true_state(50), 20.0 * sigmas());
  const NavMatrix covariance = correlated_covariance();
  Eigen::Matrix<double, 5, kNavDof> jacobian;
  for (int k = 0; k < kNavDof; ++k) {
    const NavState up = nav_plus(estimate, kStep * NavVector::Unit(k)),
                   down = nav_plus(estimate, -kStep * NavVector::Unit(k));
    jacobian.col(k) << (tilt_error(estimate, up) - tilt_error(estimate, down)) / (2 * kStep),
        (imu_velocity_error(estimate, up) - imu_velocity_error(estimate, down)) / (2 * kStep);
  }
  const Eigen::Matrix<double, 5, 5> expected = jacobian * covariance * jacobian.transpose();
  EXPECT_TRUE(tilt_covariance(estimate, covariance).isApprox(expected.topLeftCorner<2, 2>(), 1e-6));
  EXPECT_TRUE(imu_velocity_covariance(estimate, covariance).isApprox(expected.bottomRightCorner<3, 3>(), 1e-6));
}

TEST(Consistency, WhiteInnovationsPassAndCorrelatedOnesDoNot) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  SyntheticRun run = make_run(1, 1.0, correlated_covariance());
  run.states.has_innovation = true;
  Eigen::Matrix<double, 6, 1> last = Eigen::Matrix<double, 6, 1>::Zero();
  for (StateRow& row : run.states.rows) {
    for (int k = 0; k < 6; ++k) last[k] = (k < 3 ? 0.0 : 0.8 * last[k]) + normal(generator);
    row.innovation = last;
    row.nis = last.squaredNorm();
    row.nis_dof = 6;
  }
  run.states.rows[5].innovation.setConstant(std::nan(""));  // a scan without an update
  run.states.rows[5].nis = run.states.rows[5].nis_dof = std::nan("");
  const ConsistencySummary summary = summarize_consistency({series_of(run)});
  const Whiteness& white = summary.whiteness;
  EXPECT_EQ(white.samples, kScans - 1U);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(std::abs(white.correlation[k]), 1.5 * white.band);
  for (std::size_t k = 3; k < 6; ++k) EXPECT_NEAR(white.correlation[k], 0.8, 0.1);
  EXPECT_NEAR(white.deviation[0], 1.0, 0.1);
  EXPECT_GT(nees(summary, NeesBlock::kInnovation).mean, 1.2);
}

TEST(Consistency, ABlindStretchEndsWhereTheFilterIsLeastSure) {
  ConsistencySeries run(100);
  for (int i = 0; i < 100; ++i) {
    ConsistencySample& s = run[i];
    s.stamp = kStart + i * kScan;
    s.nees.fill(std::nan(""));
    s.dof.fill(1);
    s.innovation.setConstant(std::nan(""));
    s.support = i >= 20 && i < 70 ? 0.1 : 0.9;
    s.sigma_along = i < 20 ? 0.03 : i <= 60 ? 0.03 + 0.001 * (i - 19) : 0.03;
    s.along = i < 20 ? 0.01 : i <= 60 ? 0.06 : 0.0;
  }
  const ConsistencySummary summary = summarize_consistency({run});
  ASSERT_EQ(summary.blind.size(), 1U);
  EXPECT_NEAR(summary.blind[0].seconds, 4.1, 1e-9);
  EXPECT_NEAR(summary.blind[0].error, 0.05, 1e-12);
  EXPECT_NEAR(summary.blind[0].sigma, std::sqrt(0.071 * 0.071 - 0.03 * 0.03), 1e-12);
}

TEST(Consistency, ASeriesReadsBackAndRunsWithoutACommonTimeAreRefused) {
  const TemporaryDirectory directory;
  const ConsistencySeries series = series_of(make_run(1, 1.0, correlated_covariance()));
  write_consistency_csv(directory.file("series.csv"), series);
  ConsistencySeries back = read_consistency_csv(directory.file("series.csv"));
  const ConsistencySummary before = summarize_consistency({series}), after = summarize_consistency({back});
  for (const NeesBlock block : kStateBlocks)
    EXPECT_NEAR(nees(after, block).mean, nees(before, block).mean, 1e-4) << nees_block_name(block);
  EXPECT_EQ(after.three_sigma_share, before.three_sigma_share);
  for (ConsistencySample& sample : back) sample.stamp += 1;
  EXPECT_THROW(summarize_consistency({series, back}), std::runtime_error);
}

TEST(StatesCsv, MistakesNameFileLineAndColumn) {
  const TemporaryDirectory directory;
  const auto sentence_of = [&](const std::string& text) -> std::string {
    std::ofstream(directory.file("states.csv")) << text;
    try {
      read_states_csv(directory.file("states.csv"));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "was taken";
  };
  EXPECT_NE(sentence_of("").find("states.csv: is empty"), std::string::npos);
  EXPECT_NE(sentence_of("p_x,p_y\n1,2\n").find("states.csv:1: has no column t"), std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\n").find("holds no row"), std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\n1,2,3\n").find("states.csv:2: 3 cells, but the header names 2"), std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\nx,2\n").find("states.csv:2: 'x' is not a time"), std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\n2,1\n2,1\n").find("states.csv:3: the stamp 2 is not later"), std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\n2,nan\n").find("states.csv:2: column p_x: 'nan' is not a finite number"),
            std::string::npos);
  EXPECT_NE(sentence_of("t,p_x\n2,1\n").find("states.csv: has no column p_y"), std::string::npos);
}

TEST(StatesCsv, TheTruthOfVelocityAndBiasesReadsBack) {
  const TemporaryDirectory directory;
  const std::vector<TruthState> truth = {{kStart, {1, 2, 3}, {1e-3, 2e-3, 3e-3}, {0.1, 0.2, 0.3}},
                                         {kStart + 1, {4, 5, 6}, {1e-4, 2e-4, 3e-4}, {-0.1, -0.2, -0.3}}};
  write_truth_csv(directory.file("truth.csv"), truth);
  std::ofstream(directory.file("truth.csv"), std::ios::app) << "1700000000.0,1,2";  // cut off by a crash
  const std::vector<TruthState> back = read_truth_csv(directory.file("truth.csv"));
  ASSERT_EQ(back.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back[i].stamp, truth[i].stamp);
    EXPECT_EQ(back[i].velocity_world, truth[i].velocity_world);
    EXPECT_EQ(back[i].gyro_bias, truth[i].gyro_bias);
    EXPECT_EQ(back[i].accel_bias, truth[i].accel_bias);
  }
}

TEST(DeadReckoning, TheClosedFormIsWhatTheFiltersOwnPropagationGivesForALevelSteadyRide) {
  constexpr double kSeconds = 29.0, kDt = 0.005, kRelative = 1e-3;
  ImuNoise noise;
  noise.accel_psd.setConstant(3.5e-7);
  noise.accel_bias_psd.setConstant(8e-10);
  NavState state;
  state.velocity_world << 1.4, 0, 0;
  NavMatrix p = NavMatrix::Zero();  // attitude and gravity known
  const Eigen::Vector3d start(1e-4, 1e-3, 2e-4);
  for (int k = 0; k < 3; ++k)
    p(kPosition + 3 * (k == 2 ? 3 : k), kPosition + 3 * (k == 2 ? 3 : k)) = start[k] * start[k];
  const ImuInterval interval{kDt, Eigen::Vector3d::Zero(), -state.gravity_world};
  const DiscreteModel model = discretize(state, interval, noise, Discretization::kVanLoan);
  for (int i = 0; i < std::lround(kSeconds / kDt); ++i) p = model.phi * p * model.phi.transpose() + model.q;
  const Eigen::Matrix3d closed =
      axial_covariance(start.cwiseAbs2().asDiagonal(), {noise.accel_psd.x(), noise.accel_bias_psd.x()}, kSeconds);
  constexpr int kAxis[3] = {kPosition, kVelocity, kAccelBias};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(p(kAxis[i], kAxis[j]), closed(i, j), kRelative * std::sqrt(closed(i, i) * closed(j, j))) << i << j;
}

TEST(DeadReckoning, AtTheEntryTheBiasIsKnownAsWellAsASteadyFilterKnowsIt) {
  const AxialNoise noise{3.46e-7, 7.95e-10};
  // With the velocity known exactly the continuous steady state is sigma_b^2 = N_a sqrt(S_ba) (Riccati).
  const double ideal = std::sqrt(std::sqrt(noise.accel_psd * noise.accel_bias_psd));
  const double fine = std::sqrt(axial_entry_covariance(noise, 1e-5, 0.01)(2, 2));
  EXPECT_GT(fine, ideal);
  EXPECT_NEAR(fine, ideal, 0.1 * ideal);
  EXPECT_GT(std::sqrt(axial_entry_covariance(noise, 1e-2, 0.1)(2, 2)), fine);
  EXPECT_THROW(axial_entry_covariance({0.0, 1e-9}, 1e-3, 0.1), std::invalid_argument);
}

TEST(DeadReckoning, TheCorridorsBoundIsAboutADecimetre) {
  // Issue: "by a rough sum for 29 s without axial information, 0.08 to 0.12 m" for the MTi-600.
  const double sigma = portal_to_portal_sigma({3.462e-7, 7.947e-10}, 0.002, 0.1, 29.0);
  EXPECT_GT(sigma, 0.08);
  EXPECT_LT(sigma, 0.12);
}

}  // namespace
}  // namespace allan_lio
