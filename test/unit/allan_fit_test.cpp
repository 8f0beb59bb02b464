// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/allan_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "allan_lio/calib/allan_covariance.h"
#include "allan_lio/calib/chi_square.h"
#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/sim/fit_study.h"
#include "allan_lio/sim/noise_record.h"

namespace allan_lio {
namespace {

constexpr double kWhite = 1.222e-4;       // 0.42 deg/sqrt(h) [rad/s/sqrt(Hz)]
constexpr double kInstability = 5.84e-5;  // flat at 8 deg/h [rad/s]
constexpr double kRandomWalk = 2e-6;      // [rad/s^2/sqrt(Hz)]
constexpr double kHour = 3600.0;          // [s]
#ifdef __SANITIZE_ADDRESS__
constexpr int kRecords = 20;  // the sanitizers slow the simulator down by ten
#else
constexpr int kRecords = 200;
#endif

/// The curve that the model itself gives, with the terms that a record of that length would have.
AllanCurve model_curve(const NoiseTerms& terms, double tau0, double duration) {
  AllanCurve curve;
  const auto samples = static_cast<std::int64_t>(duration / tau0);
  for (const std::int64_t m : log_spaced_factors(samples / 4, 10)) {
    AllanPoint point;
    point.m = m;
    point.tau = static_cast<double>(m) * tau0;
    point.variance = model_allan_variance(terms, point.tau);
    point.terms = samples + 1 - 2 * m;
    point.record_time = duration;
    point.slide_time = static_cast<double>(point.terms) * tau0;
    curve.push_back(point);
  }
  return curve;
}

AllanCurve simulated_curve(const NoiseTerms& terms, double rate, double duration, std::uint64_t seed) {
  NoiseRecord record(terms, rate, duration, seed);
  IntegratedSeries series;
  series.tau0 = 1.0 / rate;
  series.x = {0.0};
  double sum = 0.0;
  const auto samples = static_cast<std::size_t>(rate * duration);
  for (std::size_t i = 0; i < samples; ++i) series.x.push_back((sum += record.next()) / rate);
  return overlapping_allan_variance(series, log_spaced_factors(static_cast<std::int64_t>(samples / 4), 10));
}

NoiseTerms flicker_terms() {
  NoiseTerms terms;
  terms.white = kWhite;
  terms.instability = kInstability;
  terms.random_walk = kRandomWalk;
  return terms;
}

NoiseTerms markov_terms(double time) {
  NoiseTerms terms;
  terms.white = kWhite;
  terms.markov_sigma = 6.28e-5;
  terms.markov_time = time;
  terms.random_walk = kRandomWalk;
  return terms;
}

TEST(ChiSquare, QuantilesAreThoseOfTheTables) {
  const struct {
    double probability, freedom, value;
  } table[] = {{0.95, 1, 3.841459}, {0.975, 2, 7.377759},   {0.025, 10, 3.246973}, {0.975, 10, 20.48318},
               {0.5, 4, 3.356694},  {0.025, 100, 74.22193}, {0.95, 1000, 1074.679}};
  constexpr double kPrinted = 1e-6;
  for (const auto& row : table)
    EXPECT_NEAR(chi_square_quantile(row.probability, row.freedom) / row.value, 1.0, kPrinted)
        << row.probability << " of " << row.freedom;
  EXPECT_THROW(chi_square_quantile(1.0, 3.0), std::invalid_argument);
}

TEST(ChiSquare, SkewedLimitsAreThoseOfAChiSquareWhereThereIsNothingElse) {
  constexpr double kFreedom = 30.0, kExpansion = 0.02;
  const SkewedLimits limits = skewed_limits(1.0, 0.0, 0.0, 2.0 / kFreedom);
  EXPECT_NEAR(limits.low * chi_square_quantile(0.975, kFreedom) / kFreedom, 1.0, kExpansion);
  EXPECT_NEAR(limits.high * chi_square_quantile(0.025, kFreedom) / kFreedom, 1.0, kExpansion);
  const SkewedLimits normal = skewed_limits(5.0, 1.0, 0.0, 0.0);
  EXPECT_NEAR(normal.low, 5.0 - 1.96, 1e-3);
  EXPECT_NEAR(normal.high, 5.0 + 1.96, 1e-3);
  EXPECT_EQ(skewed_limits(-0.5, 1.0, 0.0, 0.0).low, 0.0);
}

TEST(AllanCovariance, ItsVariancesHaveTheDegreesOfFreedomOfTheirPowerLaw) {
  // For averaging times far from both ends of the record the degrees of freedom are T/(tau c), c the integral of the
  // squared autocorrelation of the second differences: 2/3 for white noise (NIST SP 1065, table 5), and for a random
  // walk, whose autocorrelation is the cubic B-spline, (151/315)/(2/3)^2. For flicker noise there is the table.
  constexpr double kTau0 = 0.01, kDuration = 6.0 * kHour;
  const struct {
    NoiseTerms terms;
    double freedom_times_tau_over_record, tolerance;
  } laws[] = {{{0, 1, 0, 0, 0, 1}, 1.5, 0.005},
              {{0, 0, 1, 0, 0, 1}, 1.25, 0.08},  // the table's formula is a fit to simulations
              {{0, 0, 0, 1, 0, 1}, 1260.0 / 1359.0, 0.005}};
  for (const auto& law : laws) {
    const AllanCurve curve = model_curve(law.terms, kTau0, kDuration);
    const Eigen::VectorXd variances = AllanCovariance(curve, kTau0).variances(law.terms);
    for (std::size_t i = 0; i < curve.size(); ++i) {
      if (curve[i].m < 100 || curve[i].tau > 0.01 * kDuration) continue;
      const double freedom = 2.0 * std::pow(curve[i].variance, 2) / variances[static_cast<Eigen::Index>(i)];
      EXPECT_NEAR(freedom * curve[i].tau / curve[i].slide_time / law.freedom_times_tau_over_record, 1.0, law.tolerance)
          << "tau " << curve[i].tau;
    }
  }
}

TEST(AllanCovariance, ItsDensityGivesTheModelsVariance) {
  constexpr double kTau0 = 0.01, kQuadrature = 0.01;
  NoiseTerms terms = flicker_terms();
  terms.quantization = 1e-6;
  terms.markov_sigma = 5e-5;
  terms.markov_time = 30.0;
  for (const double tau : {0.1, 3.0, 100.0}) {
    double sum = 0.0;
    constexpr double kStep = 1e-3;
    for (double log_f = std::log(1e-4 / tau); log_f < std::log(0.5 / kTau0); log_f += kStep) {
      const double f = std::exp(log_f), m = tau / kTau0;
      const double pi_f = 3.14159265358979323846 * f;
      const double response = 2.0 * std::pow(std::sin(pi_f * tau), 4) / std::pow(m * std::sin(pi_f * kTau0), 2);
      sum += 2.0 * model_density(terms, f, kTau0) * response * f * kStep;
    }
    EXPECT_NEAR(sum / model_allan_variance(terms, tau), 1.0, kQuadrature) << "tau " << tau;
  }
}

TEST(AllanFit, TheModelsOwnCurveGivesItsCoefficientsBack) {
  constexpr double kRelative = 1e-3;
  NoiseTerms terms = flicker_terms();
  terms.quantization = 5e-6;
  const AllanFit flicker = fit_allan_variance(model_curve(terms, 0.01, 6.0 * kHour), 0.01).flicker;
  EXPECT_NEAR(flicker.quantization.value / terms.quantization, 1.0, kRelative);
  EXPECT_NEAR(flicker.white.value / kWhite, 1.0, kRelative);
  EXPECT_NEAR(flicker.instability.value / kInstability, 1.0, kRelative);
  EXPECT_NEAR(flicker.random_walk.value / kRandomWalk, 1.0, kRelative);
  EXPECT_LT(flicker.misfit, 1e-6);
  EXPECT_EQ(flicker.model_error, 0.0);

  const AxisAnalysis markov = fit_allan_variance(model_curve(markov_terms(100.0), 0.01, 6.0 * kHour), 0.01);
  EXPECT_TRUE(markov.markov_fits_better);
  EXPECT_NEAR(markov.markov.markov_time.value / 100.0, 1.0, kRelative);
  EXPECT_NEAR(markov.markov.terms.markov_sigma / 6.28e-5, 1.0, kRelative);
  EXPECT_NEAR(markov.flat.bias_time.value, markov.flat.tau.value / gauss_markov_peak_lambda(), 1e-9);
}

TEST(AllanFit, TheFlatPartIsTheMinimumOfTheCurve) {
  const AxisAnalysis analysis = fit_allan_variance(model_curve(flicker_terms(), 0.01, 24.0 * kHour), 0.01);
  // N^2/tau + K^2 tau/3 is least at sqrt(3) N/K.
  const double tau = std::sqrt(3.0) * kWhite / kRandomWalk;
  constexpr double kRelative = 2e-3;
  EXPECT_TRUE(analysis.flat.tau.observable);
  EXPECT_NEAR(analysis.flat.tau.value / tau, 1.0, kRelative);
  EXPECT_NEAR(analysis.flat.bias_time.value / (tau / 1.8926), 1.0, kRelative);
  EXPECT_NEAR(analysis.flat.deviation.value / std::sqrt(model_allan_variance(flicker_terms(), tau)), 1.0, kRelative);
  EXPECT_LT(analysis.flat.tau.low, tau);
  EXPECT_GT(analysis.flat.tau.high, tau);
}

TEST(AllanFit, AFloorWithoutAnEndGivesItsHeightButNoTime) {
  NoiseTerms terms = flicker_terms();
  terms.random_walk = 0.0;
  const AxisAnalysis analysis = fit_allan_variance(model_curve(terms, 0.01, 24.0 * kHour), 0.01);
  constexpr double kRelative = 1e-3;
  EXPECT_FALSE(analysis.flat.tau.observable);
  EXPECT_FALSE(analysis.flat.bias_time.observable);
  EXPECT_TRUE(analysis.flat.deviation.observable);
  EXPECT_NEAR(analysis.flat.deviation.value / (0.66428 * kInstability), 1.0, kRelative);
}

TEST(AllanFit, ScalingTheUnitScalesTheCoefficients) {
  constexpr double kScale = 1e6, kRelative = 1e-6;
  AllanCurve curve = simulated_curve(flicker_terms(), 50.0, kHour, 3);
  const AllanFit small = fit_allan_variance(curve, 0.02).flicker;
  for (AllanPoint& point : curve) point.variance *= kScale * kScale;
  const AllanFit large = fit_allan_variance(curve, 0.02).flicker;
  EXPECT_NEAR(large.white.value / small.white.value / kScale, 1.0, kRelative);
  EXPECT_NEAR(large.instability.high / small.instability.high / kScale, 1.0, kRelative);
}

TEST(AllanFit, AShortRecordSaysThatTheFlatPartIsNotObservable) {
  const AxisAnalysis analysis = fit_allan_variance(simulated_curve(flicker_terms(), 100.0, 60.0, 1), 0.01);
  EXPECT_TRUE(analysis.best().white.observable);
  EXPECT_FALSE(analysis.flicker.random_walk.observable);
  EXPECT_FALSE(analysis.flat.tau.observable);
  EXPECT_FALSE(analysis.flat.deviation.observable);
  EXPECT_GT(analysis.flat.deviation.high, 0.664 * kInstability) << "what is not seen is bounded from above";
}

TEST(AllanFit, WhiteNoiseAloneShowsNeitherBiasNorRandomWalkNorQuantisation) {
  NoiseTerms white;
  white.white = kWhite;
  int seen = 0, inside = 0;
  // By chance each of three terms is called observable in a twentieth of the records; 9 of 60 come once in 400 runs.
  constexpr int kSeeds = 20, kMost = 8, kLeastInside = 16;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const AxisAnalysis analysis = fit_allan_variance(simulated_curve(white, 20.0, kHour, seed), 0.05);
    seen += analysis.flicker.instability.observable + analysis.flicker.random_walk.observable +
            analysis.flicker.quantization.observable;
    inside += analysis.flicker.white.low <= kWhite && kWhite <= analysis.flicker.white.high;
  }
  EXPECT_LE(seen, kMost);
  EXPECT_GE(inside, kLeastInside);
}

TEST(AllanFit, ACurveOffTheModelGetsWiderIntervals) {
  AllanCurve curve = model_curve(flicker_terms(), 0.01, 6.0 * kHour);
  const AllanFit exact = fit_allan_variance(curve, 0.01).flicker;
  for (std::size_t i = 0; i < curve.size(); ++i) curve[i].variance *= i % 2 ? 1.05 : 0.95;
  const AllanFit off = fit_allan_variance(curve, 0.01).flicker;
  EXPECT_NEAR(off.model_error, 0.05, 0.02);
  EXPECT_GT(off.white.high - off.white.low, 5.0 * (exact.white.high - exact.white.low));
}

TEST(AllanFit, WhatASensorFiltersAtTheShortestTimesIsLeftOut) {
  // A first-order low-pass of time constant 0.02 s takes sigma^2 down by about 1 - 1.5 t/tau.
  AllanCurve curve = model_curve(flicker_terms(), 0.01, 6.0 * kHour);
  for (AllanPoint& point : curve) point.variance /= 1.0 + 1.5 * 0.02 / point.tau;
  constexpr double kFiltered = 0.04;
  const AxisAnalysis automatic = fit_allan_variance(curve, 0.01);
  EXPECT_GE(automatic.shortest, 0.1);
  EXPECT_NEAR(automatic.best().white.value / kWhite, 1.0, kFiltered);
  const AxisAnalysis all = fit_allan_variance(curve, 0.01, 0.01);
  EXPECT_EQ(all.shortest, 0.01);
  EXPECT_GT(std::abs(all.best().white.value / kWhite - 1.0), 2.0 * kFiltered);
}

TEST(AllanFit, TooFewPointsAndBrokenOnesAreRefused) {
  AllanCurve curve = model_curve(flicker_terms(), 0.01, kHour);
  AllanCurve few(curve.begin(), curve.begin() + 5);
  EXPECT_THROW(fit_allan_variance(few, 0.01), std::invalid_argument);
  EXPECT_THROW(fit_allan_variance({}, 0.01), std::invalid_argument);
  curve[3].variance = std::nan("");
  EXPECT_THROW(fit_allan_variance(curve, 0.01), std::invalid_argument);
  for (AllanPoint& point : curve) point.variance = 0.0;
  EXPECT_THROW(fit_allan_variance(curve, 0.01), std::invalid_argument) << "a constant record";
}

TEST(AllanFit, DeviationBandsHoldTheTruthAsOftenAsTheySay) {
  constexpr double kRate = 20.0, kDuration = kHour;
  constexpr int kSeeds = 40;
  NoiseTerms white;
  white.white = kWhite;
  int inside = 0, all = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const AllanCurve curve = simulated_curve(white, kRate, kDuration, seed);
    const std::vector<DeviationBand> bands = deviation_bands(curve, white, 1.0 / kRate);
    for (std::size_t i = 0; i < curve.size(); i += 6) {
      const double truth = std::sqrt(model_allan_variance(white, curve[i].tau));
      inside += bands[i].low <= truth && truth <= bands[i].high;
      ++all;
    }
  }
  EXPECT_GT(inside, 0.91 * all);
  EXPECT_LT(inside, 0.985 * all);
}

/// 200 records of 6 h at 100 Hz; of fewer the mean scatters more.
void expect_honest_intervals(bool markov) {
  FitStudy study;
  study.truth = markov ? markov_terms(100.0) : flicker_terms();
  study.records = kRecords;
  study.markov = markov;
  constexpr double kLeast = 0.90, kMost = 0.99, kFewRecords = 0.1;
  const bool few = kRecords < 200;
  for (const CoefficientStudy& row : run_study(study, 1)) {
    const double share = static_cast<double>(row.inside) / row.records;
    EXPECT_GE(share, few ? kLeast - kFewRecords : kLeast) << row.name;
    if (row.truth == 0.0) continue;
    EXPECT_LE(share, few ? 1.0 : kMost) << row.name;
    EXPECT_NEAR(row.mean / row.truth, 1.0, 0.1 * std::sqrt(200.0 / kRecords)) << row.name;
  }
}

TEST(AllanFitStudy, TheIntervalsOfFlickerNoiseHoldTheTruthAsOftenAsTheySay) { expect_honest_intervals(false); }

TEST(AllanFitStudy, TheIntervalsOfAGaussMarkovBiasHoldTheTruthAsOftenAsTheySay) { expect_honest_intervals(true); }

}  // namespace
}  // namespace allan_lio
