// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/allan_variance.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace allan_lio {
namespace {

/// A piece without a gap.
struct Piece {
  const double* x;
  std::int64_t size;
};

std::vector<Piece> split(const IntegratedSeries& series) {
  if (!(series.tau0 > 0.0) || !std::isfinite(series.tau0))
    throw std::invalid_argument("Allan variance: the spacing tau0 must be positive and finite");
  std::vector<std::size_t> ends = series.starts;
  if (ends.empty()) ends.push_back(0);
  if (ends.front() != 0) throw std::invalid_argument("Allan variance: the first piece must start at 0");
  ends.push_back(series.x.size());
  std::vector<Piece> pieces;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    if (ends[i] > ends[i + 1])
      throw std::invalid_argument("Allan variance: the starts of the pieces must ascend and lie in the series");
    pieces.push_back({series.x.data() + ends[i], static_cast<std::int64_t>(ends[i + 1] - ends[i])});
  }
  return pieces;
}

/// Sum over k < count of (c[k] - 2 b[k] + a[k])^2. Eight sums side by side, which the compiler keeps in vector
/// registers, are closed every kBlock terms: rounding does not grow with the length of the record.
double sum_of_squares(const double* a, const double* b, const double* c, std::int64_t count) {
  constexpr std::int64_t kLanes = 8, kBlock = 4096;
  double total = 0.0;
  std::int64_t k = 0;
  while (count - k >= kLanes) {
    const std::int64_t end = k + std::min(kBlock, (count - k) / kLanes * kLanes);
    double sums[kLanes] = {};
    for (; k < end; k += kLanes) {
      for (std::int64_t lane = 0; lane < kLanes; ++lane) {
        const double d = c[k + lane] - 2.0 * b[k + lane] + a[k + lane];
        sums[lane] += d * d;
      }
    }
    total += ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
  }
  for (; k < count; ++k) {
    const double d = c[k] - 2.0 * b[k] + a[k];
    total += d * d;
  }
  return total;
}

/// The same over k = 0, m, 2m, ...
double sum_of_spaced_squares(const Piece& piece, std::int64_t m) {
  double total = 0.0;
  for (std::int64_t k = 0; k + 2 * m < piece.size; k += m) {
    const double d = piece.x[k + 2 * m] - 2.0 * piece.x[k + m] + piece.x[k];
    total += d * d;
  }
  return total;
}

AllanPoint variance_at(const std::vector<Piece>& pieces, double tau0, std::int64_t m, bool overlapping) {
  AllanPoint point;
  point.m = m;
  point.tau = static_cast<double>(m) * tau0;
  double sum = 0.0;
  for (const Piece& piece : pieces) {
    const std::int64_t count = piece.size - 2 * m;
    if (count <= 0) continue;
    sum += overlapping ? sum_of_squares(piece.x, piece.x + m, piece.x + 2 * m, count) : sum_of_spaced_squares(piece, m);
    point.terms += overlapping ? count : (count + m - 1) / m;
    point.record_time += static_cast<double>(piece.size - 1) * tau0;
  }
  point.slide_time = static_cast<double>(overlapping ? point.terms : point.terms * m) * tau0;
  if (point.terms > 0) point.variance = sum / (2.0 * point.tau * point.tau * static_cast<double>(point.terms));
  return point;
}

AllanCurve allan_variance(const IntegratedSeries& series, const std::vector<std::int64_t>& factors, int threads,
                          bool overlapping) {
  for (const std::int64_t m : factors)
    if (m < 1) throw std::invalid_argument("Allan variance: the averaging factor " + std::to_string(m) + " is below 1");
  const std::vector<Piece> pieces = split(series);
  AllanCurve points(factors.size());
  // A factor is one thread's work from beginning to end, so its sum does not depend on how many there are.
  const auto work = [&](const tbb::blocked_range<std::size_t>& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      points[i] = variance_at(pieces, series.tau0, factors[i], overlapping);
  };
  const tbb::blocked_range<std::size_t> all(0, factors.size(), 1);
  if (threads > 1) {
    tbb::task_arena arena(std::min(threads, tbb::this_task_arena::max_concurrency()));
    arena.execute([&] { tbb::parallel_for(all, work, tbb::simple_partitioner()); });
  } else {
    work(all);
  }
  points.erase(std::remove_if(points.begin(), points.end(), [](const AllanPoint& p) { return p.terms == 0; }),
               points.end());
  return points;
}

}  // namespace

std::vector<std::int64_t> log_spaced_factors(std::int64_t largest, int per_decade) {
  if (per_decade < 1) throw std::invalid_argument("log_spaced_factors: at least one factor a decade is needed");
  std::vector<std::int64_t> factors;
  for (int i = 0;; ++i) {
    const double exact = std::pow(10.0, static_cast<double>(i) / per_decade);
    if (exact >= static_cast<double>(largest) + 0.5) break;
    const auto m = static_cast<std::int64_t>(std::llround(exact));
    if (m > largest) break;
    if (factors.empty() || m > factors.back()) factors.push_back(m);
  }
  return factors;
}

AllanCurve overlapping_allan_variance(const IntegratedSeries& series, const std::vector<std::int64_t>& factors,
                                      int threads) {
  return allan_variance(series, factors, threads, true);
}

AllanCurve non_overlapping_allan_variance(const IntegratedSeries& series, const std::vector<std::int64_t>& factors) {
  return allan_variance(series, factors, 1, false);
}

}  // namespace allan_lio
