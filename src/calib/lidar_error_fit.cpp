// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "allan_lio/calib/linear_trials.h"
#include "allan_lio/calib/noise_trial_run.h"
#include "search_parts.h"

namespace allan_lio {
namespace {

constexpr int kImu = 4, kAll = 8;  // k_g, k_a, k_gb, k_ab; white, view, drift of rotation, of position
constexpr double kLn10 = 2.302585092994046;

struct Point {
  NoiseSetting setting;
  LidarErrors errors;
};

/// ln of all that is fitted, and of what the priors take for likely.
Eigen::VectorXd logs_of(const Point& p) {
  Eigen::VectorXd x(kAll);
  x << p.setting.imu.k_g, p.setting.imu.k_a, p.setting.imu.k_gb, p.setting.imu.k_ab, p.errors.white, p.errors.view,
      p.errors.drift_rotation, p.errors.drift_position;
  return x.array().log();
}

Point point_at(const Eigen::VectorXd& x, Point p) {
  const Eigen::VectorXd v = x.array().exp();
  p.setting.imu = {v[0], v[1], v[2], v[3]};
  p.errors = {v[4], v[5], v[6], v[7]};
  return p;
}

class Fit {
 public:
  Fit(const std::vector<LinearisedTrial>& runs, const NoiseProblem& problem, const LidarErrorStart& start,
      LinearPool pool)
      : runs_(runs), problem_(problem), pool_(pool), start_(start) {
    for (const LinearisedTrial& run : runs)
      if (!run.run.scans.empty()) asked_.push_back({static_cast<std::uint32_t>(&run - runs.data()), start.setting, 0});
    if (asked_.empty())
      throw std::invalid_argument("every run diverged: there is nothing to fit the LiDAR's errors to");
  }

  /// BOBYQA again and again, with smaller first steps, until that gains nothing: in eight dimensions it may stop early.
  Eigen::VectorXd best() const {
    constexpr double kFirstSteps[] = {0.7, 0.3, 0.2, 0.1};          // of ln
    constexpr double kReach = 3.0, kDriftReach = 10.0;              // factors either way
    const double tolerance = start_.with_deviations ? 3e-3 : 0.02;  // of ln
    const double nothing = start_.with_deviations ? 0.02 : 0.5;     // [nats]
    const Eigen::ArrayXd likely = logs_of({});
    BoxSearch box{likely - std::log(kReach), likely + std::log(kReach), 0.0, tolerance, 600};
    box.low.tail<2>() = likely.tail<2>() - std::log(kDriftReach);
    box.high.tail<2>() = likely.tail<2>() + std::log(kDriftReach);
    box.low.head<kImu>().setConstant(std::log(problem_.lowest_k));
    box.high.head<kImu>().setConstant(std::log(problem_.highest_k));
    Eigen::VectorXd x = logs_of({start_.setting, start_.errors});
    double before = cost(x);
    for (std::size_t i = start_.warm ? 1 : 0; i < std::size(kFirstSteps); ++i) {
      box.first_step = kFirstSteps[i];
      x = minimise(box, x, [this](const Eigen::VectorXd& there) { return cost(there); });
      const double after = cost(x);
      if (before - after < nothing) break;
      before = after;
    }
    return x;
  }

  /// 1 sigma of ln k by the curvature at x: differences of a tenth.
  std::array<double, kImu> deviations(const Eigen::VectorXd& x) const {
    constexpr double kStep = 0.1;
    const auto at = [&](int i, double a, int j, double b) {
      return cost(x + a * Eigen::VectorXd::Unit(kAll, i) + b * Eigen::VectorXd::Unit(kAll, j));
    };
    const double here = cost(x);
    Eigen::Matrix<double, kAll, 1> above;
    Eigen::Matrix<double, kAll, kAll> curvature;
    for (int i = 0; i < kAll; ++i) {
      above[i] = at(i, kStep, i, 0.0);
      curvature(i, i) = above[i] + at(i, -kStep, i, 0.0) - 2.0 * here;
    }
    for (int i = 0; i < kAll; ++i)
      for (int j = 0; j < i; ++j)
        curvature(i, j) = curvature(j, i) = at(i, kStep, j, kStep) - above[i] - above[j] + here;
    const Eigen::Matrix<double, kAll, kAll> variance = (curvature / (kStep * kStep)).inverse();
    std::array<double, kImu> out;
    for (int i = 0; i < kImu; ++i)
      out[static_cast<std::size_t>(i)] =
          variance(i, i) > 0.0 ? std::sqrt(variance(i, i)) : std::numeric_limits<double>::infinity();
    return out;
  }

  Point point(const Eigen::VectorXd& x) const { return point_at(x, {start_.setting, start_.errors}); }

 private:
  double cost(const Eigen::VectorXd& x) const {
    const Point p = point(x);
    const RunTrial one = [&](const NoiseTrial& trial) {
      const LinearRun& run = runs_[trial.bag].run;
      TrialResult result;
      result.nll = score_linear(run, p.setting, p.errors, false).nll;
      if (!std::isfinite(result.nll)) result.nll = kWorstScanNll * static_cast<double>(run.scans.size());
      return result;
    };
    double sum = 0.0;
    for (const TrialResult& result : make_trial_pool(one, pool_.jobs, pool_.stop)(asked_, {}))
      sum += result.nll / problem_.runs;
    const Eigen::ArrayXd off = x - logs_of({});
    return sum + 0.5 * (off.head<kImu>() / problem_.prior_sigma).square().sum() +
           0.5 * (off.tail<kAll - kImu>() / kLn10).square().sum();
  }

  const std::vector<LinearisedTrial>& runs_;
  const NoiseProblem& problem_;
  LinearPool pool_;
  LidarErrorStart start_;
  std::vector<NoiseTrial> asked_;  ///< their `bag` is a place in runs_
};

}  // namespace

LidarErrorFit fit_lidar_errors(const std::vector<LinearisedTrial>& runs, const NoiseProblem& problem,
                               const LidarErrorStart& start, LinearPool pool) {
  const Fit fit(runs, problem, start, pool);
  const Eigen::VectorXd x = fit.best();
  LidarErrorFit out;
  out.errors = fit.point(x).errors;
  out.setting = fit.point(x).setting;
  out.deviations.fill(std::numeric_limits<double>::infinity());
  if (start.with_deviations) out.deviations = fit.deviations(x);
  return out;
}

}  // namespace allan_lio
