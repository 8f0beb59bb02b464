// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/block_likelihood.h"

#include <algorithm>
#include <cmath>

#include "allan_lio/imu/markov_step.h"

namespace allan_lio {
namespace {

constexpr int kStates = 3;  // Gauss-Markov bias, random walk, rounding of the integral

/// From one block to the next: state' = diag(transition) state + w, mean = observation . state + v.
struct BlockModel {
  double transition[kStates], observation[kStates];
  double noise[kStates];       // variances of w, which are independent of each other
  double covariance[kStates];  // of w and v
  double mean_noise;           // variance of v
  double start[kStates];       // variances at a piece's begin; that of the random walk is not used
};

BlockModel make_model(const NoiseTerms& terms, double h) {
  const MarkovStep step = markov_step(h / terms.markov_time);
  const double bias = terms.markov_sigma * terms.markov_sigma, walk = terms.random_walk * terms.random_walk,
               rounding = terms.quantization * terms.quantization;
  // The walk's end and mean: K^2 h, K^2 h/2, K^2 h/3. The mean gains the rounding at the block's end over h and loses
  // the one at its begin.
  return {{step.decay, 1.0, 0.0},
          {step.mean_gain, 1.0, -1.0 / h},
          {bias * step.value_variance, walk * h, rounding},
          {bias * step.covariance, 0.5 * walk * h, rounding / h},
          bias * step.mean_variance + walk * h / 3.0 + rounding / (h * h) + terms.white * terms.white / h,
          {bias, 0.0, rounding}};
}

/// The one-step predictor of a piece.
class Predictor {
 public:
  /// After the first mean of a piece. The walk is known from nothing else: r = mean - (the other terms of the mean),
  /// which is the limit of an infinite variance of its start.
  Predictor(const BlockModel& model, double first_mean) : model_(model) {
    double from_start[kStates][kStates] = {};  // of the state now, by the values of the other states at the begin
    for (const int i : {0, 2}) {
      from_start[i][i] = model.transition[i];
      from_start[1][i] = -model.observation[i];
    }
    for (int i = 0; i < kStates; ++i) {
      for (int j = 0; j < kStates; ++j) {
        covariance_[i][j] = i == j ? model.noise[i] : 0.0;
        for (const int k : {0, 2}) covariance_[i][j] += from_start[i][k] * from_start[j][k] * model.start[k];
      }
      state_[i] = 0.0;
    }
    // The noise of r is w - v.
    for (int i = 0; i < kStates; ++i) {
      covariance_[i][1] -= model.covariance[i];
      covariance_[1][i] -= model.covariance[i];
    }
    covariance_[1][1] += model.mean_noise;
    state_[1] = first_mean;
    find_gain();
  }

  double variance() const { return variance_; }

  /// Takes the next mean in and returns its prediction error.
  double step(double mean) {
    double error = mean;
    for (int i = 0; i < kStates; ++i) error -= model_.observation[i] * state_[i];
    for (int i = 0; i < kStates; ++i) state_[i] = model_.transition[i] * state_[i] + gain_[i] * error;
    if (!steady_) advance_covariance();
    return error;
  }

 private:
  void find_gain() {
    double projected[kStates];  // covariance of the state with what is predicted
    variance_ = model_.mean_noise;
    for (int i = 0; i < kStates; ++i) {
      projected[i] = 0.0;
      for (int j = 0; j < kStates; ++j) projected[i] += covariance_[i][j] * model_.observation[j];
      variance_ += model_.observation[i] * projected[i];
    }
    for (int i = 0; i < kStates; ++i)
      gain_[i] = (model_.transition[i] * projected[i] + model_.covariance[i]) / variance_;
  }

  void advance_covariance() {
    for (int i = 0; i < kStates; ++i) {
      for (int j = 0; j < kStates; ++j)
        covariance_[i][j] = model_.transition[i] * model_.transition[j] * covariance_[i][j] -
                            gain_[i] * gain_[j] * variance_ + (i == j ? model_.noise[i] : 0.0);
    }
    constexpr double kSettled = 1e-13;
    const double last_gain[kStates] = {gain_[0], gain_[1], gain_[2]}, last_variance = variance_;
    find_gain();
    steady_ = std::abs(variance_ - last_variance) <= kSettled * variance_;
    for (int i = 0; i < kStates; ++i) steady_ = steady_ && std::abs(gain_[i] - last_gain[i]) <= kSettled;
  }

  const BlockModel& model_;
  double state_[kStates], covariance_[kStates][kStates], gain_[kStates];
  double variance_ = 0.0;
  bool steady_ = false;
};

/// One piece. `sum` holds its values' sums up to each of them, so that all that repeats is a difference of three.
void add_pyramid(const double* sum, std::size_t count, double unit, std::vector<HaarLevel>& levels) {
  for (std::size_t level = 0, m = 1; level < levels.size(); ++level, m *= 2) {
    double squares = 0.0;
    const std::size_t differences = count / (2 * m);
    for (std::size_t k = 0; k < differences; ++k) {
      const double* at = sum + 2 * m * k;
      const double difference = at[2 * m] - 2.0 * at[m] + at[0];
      squares += difference * difference;
    }
    levels[level].variance += 0.5 * squares / (unit * unit * static_cast<double>(m) * static_cast<double>(m));
    levels[level].count += static_cast<std::int64_t>(differences);
  }
}

std::vector<HaarLevel> empty_levels(int count, double spacing) {
  std::vector<HaarLevel> levels(static_cast<std::size_t>(count));
  for (HaarLevel& level : levels) {
    level.tau = spacing;
    spacing *= 2.0;
  }
  return levels;
}

/// From sums of squares to means; levels without a difference go.
void finish(std::vector<HaarLevel>& levels) {
  for (HaarLevel& level : levels) level.variance /= std::max(1.0, static_cast<double>(level.count));
  while (!levels.empty() && levels.back().count == 0) levels.pop_back();
}

std::size_t end_of(const std::vector<std::size_t>& starts, std::size_t piece, std::size_t size) {
  return piece + 1 < starts.size() ? starts[piece + 1] : size;
}

}  // namespace

BlockedRecord block_record(const IntegratedSeries& series, int halvings) {
  BlockedRecord record;
  const std::size_t block = std::size_t{1} << halvings;
  record.block_time = static_cast<double>(block) * series.tau0;
  record.levels = empty_levels(halvings, series.tau0);
  const std::vector<std::size_t> starts = series.starts.empty() ? std::vector<std::size_t>{0} : series.starts;
  for (std::size_t piece = 0; piece < starts.size(); ++piece) {
    const std::size_t end = end_of(starts, piece, series.x.size());
    if (end <= starts[piece] + 1) continue;
    const double* x = series.x.data() + starts[piece];
    const std::size_t samples = end - starts[piece] - 1;
    add_pyramid(x, samples, series.tau0, record.levels);
    if (samples < block) continue;
    record.starts.push_back(record.means.size());
    for (std::size_t k = 0; k + block <= samples; k += block)
      record.means.push_back((x[k + block] - x[k]) / record.block_time);
  }
  finish(record.levels);
  return record;
}

std::vector<HaarLevel> haar_pyramid(const std::vector<double>& values, const std::vector<std::size_t>& starts,
                                    double spacing) {
  int depth = 0;
  while ((values.size() >> depth) > 1) ++depth;
  std::vector<HaarLevel> levels = empty_levels(depth, spacing);
  for (std::size_t piece = 0; piece < starts.size(); ++piece) {
    std::vector<double> sum = {0.0};
    for (std::size_t k = starts[piece]; k < end_of(starts, piece, values.size()); ++k)
      sum.push_back(sum.back() + values[k]);
    add_pyramid(sum.data(), sum.size() - 1, 1.0, levels);
  }
  finish(levels);
  return levels;
}

double block_log_likelihood(const BlockedRecord& record, const NoiseTerms& terms, std::vector<double>* innovations) {
  const BlockModel model = make_model(terms, record.block_time);
  double sum = 0.0;
  for (std::size_t piece = 0; piece < record.starts.size(); ++piece) {
    const std::size_t end = end_of(record.starts, piece, record.means.size());
    Predictor predictor(model, record.means[record.starts[piece]]);
    for (std::size_t k = record.starts[piece] + 1; k < end; ++k) {
      const double variance = predictor.variance();
      const double error = predictor.step(record.means[k]);
      sum += std::log(variance) + error * error / variance;
      if (innovations != nullptr) innovations->push_back(error / std::sqrt(variance));
    }
  }
  return -0.5 * sum;
}

double squared_error(const HaarLevel& level, double model_error) {
  return 2.0 / static_cast<double>(level.count) + model_error * model_error;
}

double haar_log_likelihood(const std::vector<HaarLevel>& levels, const NoiseTerms& terms, double model_error) {
  double sum = 0.0;
  for (const HaarLevel& level : levels) {
    const double ratio = level.variance / model_allan_variance(terms, level.tau);
    sum += 2.0 / squared_error(level, model_error) * (ratio - 1.0 - std::log(ratio));
  }
  return -0.5 * sum;
}

}  // namespace allan_lio
