// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/fit_study.h"

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

#include "allan_lio/calib/allan_variance.h"
#include "allan_lio/calib/noise_likelihood.h"
#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/sim/noise_record.h"

namespace allan_lio {
namespace {

constexpr int kPerDecade = 10;  // averaging times

struct Coefficient {
  const char *name, *unit;
  double truth;
  Estimate AllanFit::*estimate;
};

std::vector<Coefficient> coefficients(const FitStudy& study) {
  const NoiseTerms& t = study.truth;
  std::vector<Coefficient> list = {{"Q", "u s", t.quantization, &AllanFit::quantization},
                                   {"N", "u/sqrt(Hz)", t.white, &AllanFit::white}};
  if (study.markov) {
    // sigma_b^2 = S_b T F(lambda*) with S_b T = 2 sigma^2.
    const double flat = t.markov_sigma * std::sqrt(2.0 * gauss_markov_peak_value());
    list.push_back({"sigma_b", "u", flat, &AllanFit::markov_flat});
    list.push_back({"T_b", "s", t.markov_time, &AllanFit::markov_time});
  } else {
    list.push_back({"B", "u", t.instability, &AllanFit::instability});
  }
  list.push_back({"K", "u/s/sqrt(Hz)", t.random_walk, &AllanFit::random_walk});
  return list;
}

AllanFit fit_record(const FitStudy& study, std::uint64_t seed) {
  NoiseRecord record(study.truth, study.rate, study.duration, seed);
  IntegratedSeries series;
  series.tau0 = 1.0 / study.rate;
  const auto samples = static_cast<std::size_t>(study.rate * study.duration);
  series.x.resize(samples + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < samples; ++i) series.x[i + 1] = (sum += record.next()) / study.rate;
  const AllanCurve curve =
      overlapping_allan_variance(series, log_spaced_factors(static_cast<std::int64_t>(samples / 4), kPerDecade), 1);
  const AxisAnalysis analysis = fit_allan_variance(curve, series.tau0);
  if (!study.markov) return analysis.flicker;
  return study.likelihood ? fit_by_likelihood(series, analysis.markov, analysis.shortest) : analysis.markov;
}

}  // namespace

std::vector<CoefficientStudy> run_study(const FitStudy& study, int threads) {
  if (study.records < 1 || threads < 1) throw std::invalid_argument("a study needs records and threads");
  if (study.likelihood && !study.markov) throw std::invalid_argument("the likelihood knows only the Gauss-Markov bias");
  std::vector<AllanFit> fits(static_cast<std::size_t>(study.records));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < fits.size(); i = next++) fits[i] = fit_record(study, study.first_seed + i);
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();

  std::vector<CoefficientStudy> rows;
  for (const Coefficient& c : coefficients(study)) {
    CoefficientStudy row;
    row.name = c.name;
    row.unit = c.unit;
    row.truth = c.truth;
    row.records = study.records;
    double squares = 0.0;
    for (const AllanFit& fit : fits) {
      const Estimate& estimate = fit.*c.estimate;
      row.mean += estimate.value / study.records;
      squares += estimate.value * estimate.value / study.records;
      row.inside += estimate.low <= c.truth && c.truth <= estimate.high;
      row.observable += estimate.observable;
    }
    row.spread = std::sqrt(std::max(0.0, squares - row.mean * row.mean));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace allan_lio
