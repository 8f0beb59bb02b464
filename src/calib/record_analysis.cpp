// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/record_analysis.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "allan_lio/calib/noise_likelihood.h"
#include "allan_lio/imu/imu_noise.h"

namespace allan_lio {
namespace {

constexpr int kPerDecade = 10;

void fit_axis(const StaticRecord& record, int axis, FitMethod method, double shortest, AxisReport& report) {
  const bool constant =
      std::all_of(report.curve.begin(), report.curve.end(), [](const AllanPoint& p) { return p.variance == 0.0; });
  if (constant && !report.curve.empty()) throw std::invalid_argument("it reads the same value all the time");
  report.analysis = fit_allan_variance(report.curve, record.tau0(), shortest);
  if (method == FitMethod::kLikelihood) {
    report.analysis.markov = fit_by_likelihood(record.series(axis), report.analysis.markov, report.analysis.shortest);
    report.analysis.markov_fits_better = true;
    report.analysis.flat = flat_of_markov(report.analysis.markov);
  }
  const NoiseTerms& terms = report.analysis.best().terms;
  report.bands = deviation_bands(report.curve, terms, record.tau0());
  for (const AllanPoint& point : report.curve)
    report.fitted.push_back(std::sqrt(model_allan_variance(terms, point.tau)));
}

}  // namespace

std::string axis_name(int axis) {
  return std::string(axis < 3 ? "gyro " : "accel ") + static_cast<char>('x' + axis % 3);
}

RecordAnalysis analyse_record(const StaticRecord& record, FitMethod method, int threads, double shortest) {
  RecordAnalysis analysis;
  analysis.method = method;
  analysis.tau0 = record.tau0();
  analysis.duration = record.duration();
  for (int axis = 0; axis < StaticRecord::kAxes; ++axis) {
    AxisReport& report = analysis.axes[static_cast<std::size_t>(axis)];
    report.curve = record.curve(axis, kPerDecade, threads);
    report.mean = record.mean(axis);
  }
  tbb::task_arena arena(std::max(1, std::min(threads, tbb::this_task_arena::max_concurrency())));
  arena.execute([&] {
    tbb::parallel_for(0, StaticRecord::kAxes, [&](int axis) {
      try {
        fit_axis(record, axis, method, shortest, analysis.axes[static_cast<std::size_t>(axis)]);
      } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(axis_name(axis) + ": " + error.what());
      }
    });
  });
  return analysis;
}

}  // namespace allan_lio
