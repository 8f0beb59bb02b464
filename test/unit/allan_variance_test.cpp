// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/allan_variance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <sstream>
#include <string>

#include "shared_data.h"

namespace allan_lio {
namespace {

constexpr double kSevenDigits = 5e-7;   // relative; what a figure of 7 digits can differ by
constexpr double kFiveDigits = 5.1e-5;  // Stable32 prints 5

IntegratedSeries integrate(const std::vector<double>& y, double tau0 = 1.0) {
  IntegratedSeries series;
  series.tau0 = tau0;
  series.x.push_back(0.0);
  for (const double value : y) series.x.push_back(series.x.back() + tau0 * value);
  return series;
}

/// NIST SP 1065's test suite: n' = 16807 n mod 2147483647.
std::vector<double> nist_frequencies() {
  std::vector<double> y;
  std::uint64_t n = 1234567890;
  for (int i = 0; i < 1000; ++i) {
    y.push_back(static_cast<double>(n) / 2147483647.0);
    n = 16807 * n % 2147483647;
  }
  return y;
}

std::vector<double> white_noise(std::size_t count, unsigned seed, double sigma = 1.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<double> y(count);
  for (double& value : y) value = normal(random);
  return y;
}

double deviation(const AllanPoint& point) { return std::sqrt(point.variance); }

/// The rows of a CSV file below its header, as text.
std::vector<std::vector<std::string>> read_rows(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::vector<std::string>> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    rows.emplace_back();
    std::istringstream words(line);
    for (std::string word; std::getline(words, word, ',');) rows.back().push_back(word);
  }
  EXPECT_FALSE(rows.empty()) << path;
  return rows;
}

std::vector<double> column(const std::vector<std::vector<std::string>>& rows, std::size_t index) {
  std::vector<double> values;
  for (const auto& row : rows) values.push_back(std::stod(row.at(index)));
  return values;
}

class AllanReference : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ = shared_data("allan_reference");
    if (directory_.empty()) GTEST_SKIP() << "shared/data/allan_reference is not here";
  }
  std::vector<std::vector<std::string>> rows(const std::string& name) const {
    return read_rows(directory_ + "/" + name);
  }

  /// Published deviations (m, tau, n, dev) against those of PHASE.DAT.
  void expect_phase_dat(const std::string& name, std::size_t dev_column, bool overlapping, std::size_t count) const {
    IntegratedSeries series;
    series.x = column(rows("phase_dat.csv"), 1);
    const auto published = rows(name);
    ASSERT_EQ(published.size(), count);
    std::vector<std::int64_t> factors;
    for (const auto& row : published) factors.push_back(std::stoll(row[0]));
    const AllanCurve curve =
        overlapping ? overlapping_allan_variance(series, factors, 2) : non_overlapping_allan_variance(series, factors);
    ASSERT_EQ(curve.size(), published.size());
    for (std::size_t i = 0; i < curve.size(); ++i) {
      const double expected = std::stod(published[i][dev_column]);
      EXPECT_EQ(curve[i].m, factors[i]);
      EXPECT_EQ(curve[i].terms, std::stoll(published[i][2])) << name << " m " << factors[i];
      EXPECT_NEAR(deviation(curve[i]), expected, kFiveDigits * expected) << name << " m " << factors[i];
    }
  }

  std::string directory_;
};

TEST(AllanVariance, NistSuiteOfOneThousandPointsComesOutToSevenDigits) {
  const IntegratedSeries series = integrate(nist_frequencies());
  const AllanCurve overlapping = overlapping_allan_variance(series, {1, 10, 100});
  const AllanCurve plain = non_overlapping_allan_variance(series, {1, 10, 100});
  const double expected_overlapping[] = {2.922319e-01, 9.159953e-02, 3.241343e-02};
  const double expected_plain[] = {2.922319e-01, 9.965736e-02, 3.897804e-02};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(deviation(overlapping[i]), expected_overlapping[i], kSevenDigits * expected_overlapping[i]);
    EXPECT_NEAR(deviation(plain[i]), expected_plain[i], kSevenDigits * expected_plain[i]);
  }
  EXPECT_EQ(overlapping[1].terms, 981);
  EXPECT_EQ(plain[1].terms, 99);
  EXPECT_EQ(overlapping[1].tau, 10.0);
  EXPECT_EQ(overlapping[1].record_time, 1000.0);
}

TEST_F(AllanReference, PublishedFiguresOfTheNbs14SetsComeOut) {
  const struct {
    std::string values, deviations;
    bool phase;
    std::vector<std::int64_t> factors;
  } sets[] = {{"nbs14_9point_freq.csv", "nbs14_9point_deviations.csv", false, {1, 2}},
              {"nbs14_1000point_freq.csv", "nbs14_1000point_deviations.csv", false, {1, 10, 100}}};
  for (const auto& set : sets) {
    const auto values = rows(set.values);
    const IntegratedSeries series = integrate(column(values, values[0].size() - 1));
    std::map<std::string, AllanCurve> curves;
    curves["adev"] = non_overlapping_allan_variance(series, set.factors);
    curves["oadev"] = overlapping_allan_variance(series, set.factors);
    std::size_t compared = 0;
    for (const auto& row : rows(set.deviations)) {
      if (curves.count(row[0]) == 0) continue;
      for (std::size_t i = 0; i < set.factors.size(); ++i, ++compared) {
        const double expected = std::stod(row[i + 1]);
        EXPECT_NEAR(deviation(curves[row[0]][i]), expected, kSevenDigits * expected) << set.values << " " << row[0];
      }
    }
    EXPECT_EQ(compared, 2 * set.factors.size());
  }
}

TEST_F(AllanReference, PhaseDataGiveTheSameAsFrequencies) {
  constexpr double kFiveDecimals = 1e-5;  // of the phases, which are about 100
  IntegratedSeries phase;
  phase.x = column(rows("nbs14_10point_phase.csv"), 1);
  const IntegratedSeries frequency = integrate(column(rows("nbs14_9point_freq.csv"), 1));
  const AllanCurve a = overlapping_allan_variance(phase, {1, 2}), b = overlapping_allan_variance(frequency, {1, 2});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(deviation(a[i]), deviation(b[i]), kFiveDecimals);
}

TEST_F(AllanReference, EveryFactorOfPhaseDatComesOutAsStable32PrintsIt) {
  expect_phase_dat("phase_dat_oadev.csv", 3, true, 139);
  expect_phase_dat("phase_dat_oadev_octave.csv", 5, true, rows("phase_dat_oadev_octave.csv").size());
  expect_phase_dat("phase_dat_adev.csv", 3, false, rows("phase_dat_adev.csv").size());
}

TEST(AllanVariance, PiecesAreTheirPooledSums) {
  const std::vector<double> first = white_noise(5000, 1), second = white_noise(777, 2);
  const IntegratedSeries a = integrate(first, 0.01), b = integrate(second, 0.01);
  IntegratedSeries both = a;
  both.starts = {0, a.x.size()};
  both.x.insert(both.x.end(), b.x.begin(), b.x.end());
  const std::vector<std::int64_t> factors = {1, 7, 100, 388, 389, 1000};
  for (const bool overlapping : {true, false}) {
    const auto run = [&](const IntegratedSeries& s) {
      return overlapping ? overlapping_allan_variance(s, factors) : non_overlapping_allan_variance(s, factors);
    };
    const AllanCurve pooled = run(both), one = run(a), two = run(b);
    ASSERT_EQ(pooled.size(), factors.size());
    ASSERT_EQ(two.size(), 4U) << "389 and 1000 are too long for the second piece";
    for (std::size_t i = 0; i < pooled.size(); ++i) {
      const bool has_two = i < two.size();
      const auto n1 = static_cast<double>(one[i].terms), n2 = has_two ? static_cast<double>(two[i].terms) : 0.0;
      const double expected = (n1 * one[i].variance + (has_two ? n2 * two[i].variance : 0.0)) / (n1 + n2);
      EXPECT_NEAR(pooled[i].variance, expected, 1e-14 * expected);
      EXPECT_EQ(static_cast<double>(pooled[i].terms), n1 + n2);
      EXPECT_NEAR(pooled[i].record_time, has_two ? 57.77 : 50.0, 1e-9);
    }
  }
}

TEST(AllanVariance, ThreadsDoNotChangeABit) {
  const IntegratedSeries series = integrate(white_noise(200000, 3));
  const std::vector<std::int64_t> factors = log_spaced_factors(60000, 12);
  const AllanCurve one = overlapping_allan_variance(series, factors, 1);
  for (const int threads : {2, 3, 8, 200}) {
    const AllanCurve many = overlapping_allan_variance(series, factors, threads);
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(many[i].variance, one[i].variance);
  }
}

TEST(AllanVariance, WhiteNoiseGivesItsDensityOverTau) {
  constexpr double kDensity = 2e-3, kTau0 = 0.005, kSigmas = 4.0;
  const std::size_t count = 400000;
  const IntegratedSeries series = integrate(white_noise(count, 4, kDensity / std::sqrt(kTau0)), kTau0);
  for (const AllanPoint& point : overlapping_allan_variance(series, log_spaced_factors(20000, 5), 2)) {
    // NIST SP 1065, table 5: degrees of freedom of white frequency noise.
    const double n = static_cast<double>(count) + 1.0, m = static_cast<double>(point.m);
    const double freedom = (3.0 * (n - 1.0) / (2.0 * m) - 2.0 * (n - 2.0) / n) * 4.0 * m * m / (4.0 * m * m + 5.0);
    const double expected = kDensity * kDensity / point.tau;
    EXPECT_NEAR(point.variance, expected, kSigmas * std::sqrt(2.0 / freedom) * expected) << "m " << point.m;
  }
}

TEST(AllanVariance, AConstantRateCancels) {
  std::vector<double> y = white_noise(3000, 5);
  const AllanCurve without = overlapping_allan_variance(integrate(y), {1, 30});
  for (double& value : y) value += 10.0;
  const AllanCurve with = overlapping_allan_variance(integrate(y), {1, 30});
  for (std::size_t i = 0; i < 2; ++i) EXPECT_NEAR(with[i].variance, without[i].variance, 1e-9);
}

TEST(AllanVariance, FactorsAscendFromOneAndEachComesOnce) {
  const std::vector<std::int64_t> factors = log_spaced_factors(1000000, 10);
  EXPECT_EQ(factors.front(), 1);
  EXPECT_EQ(factors.back(), 1000000);
  for (std::size_t i = 1; i < factors.size(); ++i) EXPECT_GT(factors[i], factors[i - 1]);
  EXPECT_NEAR(static_cast<double>(factors.size()), 60.0, 5.0);
  EXPECT_TRUE(log_spaced_factors(0, 10).empty());
  EXPECT_EQ(log_spaced_factors(1, 10), std::vector<std::int64_t>{1});
}

TEST(AllanVariance, WhatMakesNoSenseIsRefused) {
  IntegratedSeries series = integrate(white_noise(10, 6));
  EXPECT_THROW(overlapping_allan_variance(series, {0}), std::invalid_argument);
  EXPECT_THROW(log_spaced_factors(10, 0), std::invalid_argument);
  for (const std::vector<std::size_t>& starts : {std::vector<std::size_t>{1, 3}, {0, 5, 4}, {0, 12}}) {
    series.starts = starts;
    EXPECT_THROW(overlapping_allan_variance(series, {1}), std::invalid_argument);
  }
  series.starts.clear();
  for (const double tau0 : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    series.tau0 = tau0;
    EXPECT_THROW(overlapping_allan_variance(series, {1}), std::invalid_argument);
  }
}

TEST(AllanVariance, ARecordTooShortForAFactorHasNoPointThere) {
  const IntegratedSeries series = integrate(white_noise(10, 7));
  EXPECT_EQ(overlapping_allan_variance(series, {1, 5, 6}).size(), 2U);
  EXPECT_TRUE(overlapping_allan_variance(IntegratedSeries{}, {1}).empty());
}

}  // namespace
}  // namespace allan_lio
