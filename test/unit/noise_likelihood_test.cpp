// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/noise_likelihood.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "allan_lio/calib/block_likelihood.h"
#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/sim/noise_record.h"

namespace allan_lio {
namespace {

constexpr double kRate = 100.0;  // [Hz]

/// The covariance of the means of blocks of length h, written out; the random walk starts at zero.
Eigen::MatrixXd covariance_of_means(const NoiseTerms& terms, double h, int count) {
  const double a = h / terms.markov_time, white = terms.white * terms.white / h,
               rounding = std::pow(terms.quantization / h, 2), bias = std::pow(terms.markov_sigma / a, 2),
               walk = terms.random_walk * terms.random_walk * h;
  Eigen::MatrixXd covariance(count, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j <= i; ++j) {
      const int apart = i - j;
      double sum = apart == 0 ? bias * 2.0 * (a - 1.0 + std::exp(-a))
                              : bias * std::pow(1.0 - std::exp(-a), 2) * std::exp(-(apart - 1) * a);
      sum += walk * (j + (apart == 0 ? 1.0 / 3.0 : 0.5));
      if (apart == 0) sum += white + 2.0 * rounding;
      if (apart == 1) sum -= rounding;
      covariance(i, j) = covariance(j, i) = sum;
    }
  }
  return covariance;
}

/// ln L of what the means tell beside an unknown constant: of their differences from the first.
double dense_log_likelihood(const Eigen::VectorXd& means, const NoiseTerms& terms, double h) {
  const auto count = static_cast<int>(means.size());
  Eigen::MatrixXd from_first(count - 1, count);
  from_first << Eigen::VectorXd::Constant(count - 1, -1.0), Eigen::MatrixXd::Identity(count - 1, count - 1);
  const Eigen::VectorXd differences = from_first * means;
  const Eigen::LLT<Eigen::MatrixXd> root(
      Eigen::MatrixXd(from_first * covariance_of_means(terms, h, count) * from_first.transpose()));
  const Eigen::MatrixXd lower = root.matrixL();
  return -lower.diagonal().array().log().sum() - 0.5 * differences.dot(root.solve(differences));
}

BlockedRecord random_means(double h, const std::vector<int>& pieces) {
  BlockedRecord record;
  record.block_time = h;
  NormalStream normals(5, 0);
  double walk = 0.0;
  for (const int count : pieces) {
    record.starts.push_back(record.means.size());
    for (int k = 0; k < count; ++k) record.means.push_back(3.0 + (walk += 0.3 * normals.next()) + normals.next());
  }
  return record;
}

void expect_dense(const BlockedRecord& record, const NoiseTerms& terms) {
  constexpr double kRelative = 1e-9;
  double expected = 0.0;
  for (std::size_t piece = 0; piece < record.starts.size(); ++piece) {
    const std::size_t begin = record.starts[piece],
                      end = piece + 1 < record.starts.size() ? record.starts[piece + 1] : record.means.size();
    expected += dense_log_likelihood(
        Eigen::Map<const Eigen::VectorXd>(record.means.data() + begin, static_cast<Eigen::Index>(end - begin)), terms,
        record.block_time);
  }
  EXPECT_NEAR(block_log_likelihood(record, terms), expected, kRelative * std::abs(expected));
}

TEST(BlockLikelihood, IsTheGaussianDensityWithItsCovarianceWrittenOut) {
  const NoiseTerms all{0.6, 1.1, 0.0, 0.2, 0.9, 8.0};
  const BlockedRecord record = random_means(2.0, {50});
  expect_dense(record, all);
  double NoiseTerms::*const members[] = {&NoiseTerms::quantization, &NoiseTerms::random_walk,
                                         &NoiseTerms::markov_sigma};
  for (const auto member : members) {
    NoiseTerms without = all, strong = all;
    without.*member = 0.0;
    strong.*member *= 20.0;
    expect_dense(record, without);
    expect_dense(record, strong);
  }
}

TEST(BlockLikelihood, StaysSoWhenTheGainIsSteadyAndInSeveralPieces) {
  expect_dense(random_means(2.0, {400}), {0.6, 1.1, 0.0, 0.2, 0.9, 8.0});
  expect_dense(random_means(2.0, {60, 1, 90, 2}), {0.6, 1.1, 0.0, 0.2, 0.9, 8.0});
}

TEST(BlockLikelihood, ThePyramidUsesEverySampleOnceALevel) {
  // Rates 1 3 2 6 5 | 4 4, a sample every 0.5 s.
  IntegratedSeries series;
  series.tau0 = 0.5;
  series.x = {0.0, 0.5, 2.0, 3.0, 6.0, 8.5, 1.0, 3.0, 5.0};
  series.starts = {0, 6};
  const BlockedRecord record = block_record(series, 2);
  ASSERT_EQ(record.levels.size(), 2u);
  EXPECT_EQ(record.levels[0].count, 3);  // 3-1, 6-2, 4-4
  EXPECT_DOUBLE_EQ(record.levels[0].tau, 0.5);
  EXPECT_DOUBLE_EQ(record.levels[0].variance, 0.5 * (4.0 + 16.0 + 0.0) / 3.0);
  EXPECT_EQ(record.levels[1].count, 1);  // 4-2
  EXPECT_DOUBLE_EQ(record.levels[1].tau, 1.0);
  EXPECT_DOUBLE_EQ(record.levels[1].variance, 0.5 * 4.0);
  EXPECT_DOUBLE_EQ(record.block_time, 2.0);
  EXPECT_EQ(record.means, std::vector<double>({3.0}));
}

IntegratedSeries integrated_record(const NoiseTerms& terms, double duration, std::uint64_t seed) {
  IntegratedSeries series;
  series.tau0 = 1.0 / kRate;
  NoiseRecord noise(terms, kRate, duration, seed);
  series.x = {0.0};
  for (auto k = static_cast<int>(duration * kRate); k > 0; --k)
    series.x.push_back(series.x.back() + series.tau0 * noise.next());
  return series;
}

AllanFit start_from(double white) {
  AllanFit start;
  start.terms.white = white;
  return start;
}

bool holds(const Estimate& estimate, double truth) { return estimate.low <= truth && truth <= estimate.high; }

TEST(NoiseLikelihood, TheIntervalsHoldTheTruthThatARecordWasMadeOf) {
  constexpr int kSeeds = 4, kMostMissed = 3;  // of 20; more than three are missed once in sixty such tests
  const NoiseTerms terms{5e-6, 1.2e-4, 0.0, 2e-6, 1.5e-4, 20.0};
  int missed = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const AllanFit fit = fit_by_likelihood(integrated_record(terms, 7200.0, seed), start_from(1.3e-4));
    EXPECT_TRUE(fit.quantization.observable && fit.white.observable && fit.markov_flat.observable &&
                fit.markov_time.observable);
    EXPECT_FALSE(fit.instability.observable);
    missed += !holds(fit.quantization, terms.quantization) + !holds(fit.white, terms.white) +
              !holds(fit.random_walk, terms.random_walk) + !holds(fit.markov_time, terms.markov_time) +
              !holds(fit.markov_flat, terms.markov_sigma * std::sqrt(2.0 * gauss_markov_peak_value()));
    EXPECT_NEAR(fit.white.value, terms.white, 0.01 * terms.white);
    EXPECT_LT(fit.white.high, 1.01 * fit.white.low);
    EXPECT_NEAR(std::log(fit.markov_time.value / terms.markov_time), 0.0, 0.5);
    EXPECT_LT(fit.markov_time.high, 3.0 * fit.markov_time.low);
    EXPECT_LT(fit.misfit, 4.0);
  }
  EXPECT_LE(missed, kMostMissed);
}

TEST(NoiseLikelihood, ABiasThatIsNotThereIsNotObservableButBounded) {
  NoiseTerms terms;
  terms.white = 1.2e-4;
  terms.random_walk = 4e-6;
  const AllanFit fit = fit_by_likelihood(integrated_record(terms, 7200.0, 11), start_from(1.3e-4));
  EXPECT_FALSE(fit.markov_flat.observable);
  EXPECT_FALSE(fit.markov_time.observable);
  EXPECT_FALSE(fit.quantization.observable);
  EXPECT_EQ(fit.markov_flat.low, 0.0);
  EXPECT_GT(fit.markov_flat.high, 1e-6);
  EXPECT_LT(fit.markov_flat.high, 2e-4);
  EXPECT_TRUE(fit.random_walk.observable);
  EXPECT_TRUE(holds(fit.random_walk, terms.random_walk));
  EXPECT_LT(fit.random_walk.high, 2.5 * fit.random_walk.low);
}

TEST(NoiseLikelihood, WhiteNoiseAloneIsFoundAloneAndASlowBiasHasNoUpperBoundOnItsTime) {
  NoiseTerms terms;
  terms.white = 1.2e-4;
  const AllanFit white = fit_by_likelihood(integrated_record(terms, 3600.0, 3), start_from(1.2e-4));
  EXPECT_TRUE(white.white.observable);
  EXPECT_FALSE(white.quantization.observable || white.markov_flat.observable || white.random_walk.observable);
  terms.markov_sigma = 1e-3;
  terms.markov_time = 20000.0;
  const AllanFit slow = fit_by_likelihood(integrated_record(terms, 3600.0, 3), start_from(1.2e-4));
  EXPECT_FALSE(slow.markov_time.observable);
  EXPECT_TRUE(std::isinf(slow.markov_time.high));
  EXPECT_TRUE(slow.random_walk.observable);  // which is all that an hour can tell of it
  constexpr double kThreeSigma = 0.27;
  const double driving = terms.markov_sigma * std::sqrt(2.0 / terms.markov_time);
  EXPECT_NEAR(std::log(slow.random_walk.value / driving), 0.0, kThreeSigma);
}

TEST(NoiseLikelihood, WhatIsUnknownOfEachPieceMakesNoDifference) {
  constexpr double kRounding = 1e-3;  // of the search; a hundredth of the intervals
  const NoiseTerms terms{0.0, 1.2e-4, 0.0, 0.0, 1.5e-4, 20.0};
  IntegratedSeries whole = integrated_record(terms, 3000.0, 5), cut;
  cut.tau0 = whole.tau0;
  for (const std::size_t begin : {0, 100000, 200000}) {
    cut.starts.push_back(cut.x.size());
    cut.x.insert(cut.x.end(), whole.x.begin() + begin, whole.x.begin() + begin + 100001);
  }
  IntegratedSeries shifted = cut;
  for (std::size_t k = 0; k < shifted.x.size(); ++k) {
    const std::size_t piece = k / 100001, within = k % 100001;
    shifted.x[k] += static_cast<double>(piece) * (7.0 + 1e-3 * shifted.tau0 * static_cast<double>(within));
  }
  const AllanFit a = fit_by_likelihood(cut, start_from(1.2e-4)), b = fit_by_likelihood(shifted, start_from(1.2e-4));
  EXPECT_TRUE(a.markov_time.observable);
  EXPECT_NEAR(b.white.value / a.white.value, 1.0, kRounding);
  EXPECT_NEAR(b.markov_flat.value / a.markov_flat.value, 1.0, kRounding);
  EXPECT_NEAR(b.markov_time.value / a.markov_time.value, 1.0, kRounding);
}

TEST(NoiseLikelihood, ASensorsFilterAtTheShortestTimesDoesNotSpoilTheRest) {
  constexpr int kFilter = 8;  // samples of a moving mean
  constexpr double kSameWithin = 0.03;
  const NoiseTerms terms{0.0, 1.2e-4, 0.0, 0.0, 1.5e-4, 20.0};
  const IntegratedSeries raw = integrated_record(terms, 3600.0, 2);
  IntegratedSeries filtered;
  filtered.tau0 = raw.tau0;
  double sum = 0.0;
  for (std::size_t k = 0; k < raw.x.size(); ++k) {
    sum += raw.x[k] - (k >= kFilter ? raw.x[k - kFilter] : 0.0);
    if (k + 1 >= kFilter) filtered.x.push_back(sum / kFilter);
  }
  const AllanFit plain = fit_by_likelihood(raw, start_from(1.2e-4));
  EXPECT_EQ(plain.model_error, 0.0);
  // A moving mean of length w takes a share of the order of w/tau off the variance.
  const AllanFit whole = fit_by_likelihood(filtered, start_from(1.2e-4));
  EXPECT_GT(whole.model_error, 0.05);
  EXPECT_NEAR(whole.white.value / terms.white, 1.0, 0.1);
  EXPECT_NEAR(whole.markov_flat.value / plain.markov_flat.value, 1.0, kSameWithin);
  const AllanFit cut = fit_by_likelihood(filtered, start_from(1.2e-4), 16.0 * kFilter * raw.tau0);
  EXPECT_TRUE(holds(cut.white, terms.white)) << cut.white.low << " to " << cut.white.high;
  EXPECT_LT(cut.white.high, 1.2 * cut.white.low);
  EXPECT_NEAR(cut.markov_flat.value / plain.markov_flat.value, 1.0, kSameWithin);
}

TEST(NoiseLikelihood, TheSameRecordGivesTheSameBits) {
  const NoiseTerms terms{0.0, 1.2e-4, 0.0, 0.0, 1.5e-4, 20.0};
  const IntegratedSeries series = integrated_record(terms, 600.0, 5);
  const AllanFit a = fit_by_likelihood(series, start_from(1.2e-4)), b = fit_by_likelihood(series, start_from(1.2e-4));
  EXPECT_EQ(a.white.value, b.white.value);
  EXPECT_EQ(a.white.low, b.white.low);
  EXPECT_EQ(a.markov_flat.high, b.markov_flat.high);
  EXPECT_EQ(a.misfit, b.misfit);
}

TEST(NoiseLikelihood, RefusesARecordThatIsTooShortOrDoesNotChange) {
  NoiseTerms terms;
  terms.white = 1.0;
  EXPECT_THROW(fit_by_likelihood(integrated_record(terms, 2.0, 1), start_from(1.0)), std::invalid_argument);
  EXPECT_NO_THROW(fit_by_likelihood(integrated_record(terms, 3.0, 1), start_from(1.0)));
  EXPECT_THROW(fit_by_likelihood({1.0, {}, {}}, start_from(1.0)), std::invalid_argument);
  EXPECT_THROW(fit_by_likelihood({0.01, std::vector<double>(1000, 0.0), {}}, start_from(1.0)), std::invalid_argument);
  EXPECT_THROW(fit_by_likelihood({0.01, std::vector<double>(1000, std::nan("")), {}}, start_from(1.0)),
               std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
