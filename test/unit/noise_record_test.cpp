// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/noise_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace allan_lio {
namespace {

constexpr double kRate = 100.0;                                                  // [Hz]
constexpr double kFlat = 2.0 * 0.69314718055994530942 / 3.14159265358979323846;  // sigma^2/B^2 of flicker noise

std::vector<double> record_of(const NoiseTerms& terms, std::size_t count, std::uint64_t seed) {
  NoiseRecord noise(terms, kRate, static_cast<double>(count) / kRate, seed);
  std::vector<double> record(count);
  for (double& sample : record) sample = noise.next();
  return record;
}

/// Overlapping Allan variance of samples 1/kRate apart.
double allan_variance(const std::vector<double>& record, std::size_t m) {
  std::vector<double> sum(record.size() + 1, 0.0);
  for (std::size_t k = 0; k < record.size(); ++k) sum[k + 1] = sum[k] + record[k];
  double squares = 0.0;
  for (std::size_t k = 0; k + 2 * m < sum.size(); ++k)
    squares += std::pow(sum[k + 2 * m] - 2.0 * sum[k + m] + sum[k], 2);
  return 0.5 * squares / (static_cast<double>(m * m) * static_cast<double>(sum.size() - 2 * m));
}

struct Mean {
  double value = 0.0, standard_error = 0.0;
};

/// Over many seeds.
Mean mean_allan_variance(const NoiseTerms& terms, std::size_t m) {
  constexpr int kSeeds = 300;
  constexpr std::size_t kSamples = 3000;
  double sum = 0.0, squares = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const double value = allan_variance(record_of(terms, kSamples, 1000 + seed), m);
    sum += value;
    squares += value * value;
  }
  const double mean = sum / kSeeds;
  return {mean, std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1))};
}

void expect_model(const NoiseTerms& terms, const char* name) {
  constexpr double kStandardErrors = 4.0;
  for (const std::size_t m : {1, 4, 30, 200, 600}) {
    const Mean mean = mean_allan_variance(terms, m);
    const double model = model_allan_variance(terms, static_cast<double>(m) / kRate);
    EXPECT_NEAR(mean.value, model, kStandardErrors * mean.standard_error) << name << ", m = " << m;
    // The test must be able to tell a tenth of the deviation.
    EXPECT_LT(kStandardErrors * mean.standard_error, 0.42 * model) << name << ", m = " << m;
  }
}

TEST(NoiseRecord, QuantisationHasTheAllanVarianceOfTheModel) {
  NoiseTerms terms;
  terms.quantization = 3e-4;
  expect_model(terms, "quantisation");
}

TEST(NoiseRecord, WhiteNoiseHasTheAllanVarianceOfTheModel) {
  NoiseTerms terms;
  terms.white = 0.01;
  expect_model(terms, "white noise");
}

TEST(NoiseRecord, ARandomWalkHasTheAllanVarianceOfTheModelFromASampleOn) {
  NoiseTerms terms;
  terms.random_walk = 0.02;
  expect_model(terms, "random walk");
}

TEST(NoiseRecord, AGaussMarkovBiasHasTheAllanVarianceOfTheModelFromASampleOn) {
  NoiseTerms terms;
  terms.markov_sigma = 0.3;
  for (const double time : {0.02, 1.0, 50.0}) {
    terms.markov_time = time;
    expect_model(terms, "Gauss-Markov");
  }
}

TEST(NoiseRecord, AGaussMarkovBiasIsStationaryFromTheFirstSampleOn) {
  constexpr int kSeeds = 4000;
  constexpr double kStandardErrors = 4.0;
  NoiseTerms terms;
  terms.markov_sigma = 2.0;
  terms.markov_time = 100.0;
  double first = 0.0, last = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const std::vector<double> record = record_of(terms, 50, seed);
    first += record.front() * record.front() / kSeeds;
    last += record.back() * record.back() / kSeeds;
  }
  EXPECT_NEAR(first, 4.0, kStandardErrors * 4.0 * std::sqrt(2.0 / kSeeds));
  EXPECT_NEAR(last, 4.0, kStandardErrors * 4.0 * std::sqrt(2.0 / kSeeds));
}

/// Allan variances at `factors` (ascending) of the sum of held processes, in closed form: the covariance of a held
/// process over all its phases is linear between multiples of the hold.
std::vector<double> closed_form(const std::vector<FlickerProcess>& processes, const std::vector<std::size_t>& factors) {
  std::vector<double> result(factors.size(), 0.0);
  for (const FlickerProcess& process : processes) {
    const double decay = process.time > 0 ? std::exp(-static_cast<double>(process.hold) / (kRate * process.time)) : 0.0;
    double at = process.sigma * process.sigma;  // the covariance at the last multiple
    const double n = static_cast<double>(process.hold);
    const std::size_t longest = 2 * factors.back();
    std::vector<double> variance(longest + 1, 0.0);  // of the sum of so many samples
    double covariances = 0.5 * at, phase = 0.0;      // sum of those up to the lag, half of lag 0
    for (std::size_t m = 1; m <= longest; ++m) {
      variance[m] = variance[m - 1] + 2.0 * covariances;
      if (++phase == n) {
        phase = 0.0;
        at *= decay;
      }
      covariances += at * (1.0 + (decay - 1.0) * phase / n);
    }
    for (std::size_t i = 0; i < factors.size(); ++i) {
      const double m = static_cast<double>(factors[i]);
      result[i] += (4.0 * variance[factors[i]] - variance[2 * factors[i]]) / (2.0 * m * m);
    }
  }
  return result;
}

TEST(NoiseRecord, FlickerNoiseIsFlatWithinOnePercentFromTenSamplesToAFifthOfTheRecord) {
  constexpr double kB = 0.5, kTolerance = 0.01;
  for (const double duration : {100.0, 3600.0, 21600.0}) {
    const auto longest = static_cast<std::size_t>(duration * kRate / 5.0);
    std::vector<std::size_t> factors;
    for (double m = 10.0; m < static_cast<double>(longest); m *= 1.1) factors.push_back(static_cast<std::size_t>(m));
    factors.push_back(longest);
    const std::vector<double> variances = closed_form(flicker_processes(kB, kRate, duration), factors);
    for (std::size_t i = 0; i < factors.size(); ++i)
      EXPECT_NEAR(std::sqrt(variances[i] / (kFlat * kB * kB)), 1.0, kTolerance) << duration << " s, m = " << factors[i];
  }
}

TEST(NoiseRecord, FlickerNoiseFollowsTheClosedFormOfItsProcesses) {
  constexpr double kStandardErrors = 4.0;
  NoiseTerms terms;
  terms.instability = 0.5;
  const std::vector<std::size_t> factors = {1, 4, 10, 30, 200, 600};
  const std::vector<double> expected = closed_form(flicker_processes(0.5, kRate, 30.0), factors);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    const Mean mean = mean_allan_variance(terms, factors[i]);
    EXPECT_NEAR(mean.value, expected[i], kStandardErrors * mean.standard_error) << "m = " << factors[i];
  }
}

TEST(NoiseRecord, TheSameSeedGivesTheSameBitsAndAnotherSeedOthers) {
  const NoiseTerms terms{1e-4, 0.01, 0.1, 0.02, 0.3, 5.0};
  const std::vector<double> record = record_of(terms, 1000, 7), same = record_of(terms, 1000, 7);
  EXPECT_EQ(record, same);
  const std::vector<double> other = record_of(terms, 1000, 8);
  for (std::size_t k = 0; k < record.size(); ++k) ASSERT_NE(record[k], other[k]);
}

TEST(NoiseRecord, SwitchingATermOffLeavesTheOthersAlone) {
  constexpr double kRounding = 1e-12;
  const NoiseTerms all{1e-4, 0.01, 0.1, 0.02, 0.3, 5.0};
  double NoiseTerms::*const members[] = {&NoiseTerms::quantization, &NoiseTerms::white, &NoiseTerms::instability,
                                         &NoiseTerms::random_walk, &NoiseTerms::markov_sigma};
  const std::vector<double> whole = record_of(all, 500, 7);
  for (const auto member : members) {
    NoiseTerms without = all, alone;
    without.*member = 0.0;
    alone.markov_time = all.markov_time;
    alone.*member = all.*member;
    const std::vector<double> a = record_of(without, 500, 7), b = record_of(alone, 500, 7);
    for (std::size_t k = 0; k < whole.size(); ++k) ASSERT_NEAR(a[k] + b[k], whole[k], kRounding);
  }
}

TEST(NoiseRecord, RefusesWhatCannotBe) {
  NoiseTerms terms;
  EXPECT_THROW(NoiseRecord(terms, 0.0, 1.0, 1), std::invalid_argument);
  EXPECT_THROW(NoiseRecord(terms, 1.0, std::nan(""), 1), std::invalid_argument);
  terms.white = -1.0;
  EXPECT_THROW(NoiseRecord(terms, 1.0, 1.0, 1), std::invalid_argument);
  terms = {};
  terms.markov_time = 0.0;
  EXPECT_THROW(NoiseRecord(terms, 1.0, 1.0, 1), std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
