// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/horizon_likelihood.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/interval_noise.h"
#include "allan_lio/imu/propagate.h"

namespace allan_lio {
namespace {

constexpr double kLog2Pi = 1.83787706640934548356;
constexpr double kBeginsPerHorizon = 4.0;

/// What lies between two scans' states.
struct Step {
  std::vector<ImuSample> samples;
  NavMatrix phi = NavMatrix::Identity();
  NavMatrix q = NavMatrix::Zero();
};

Step make_step(const ImuBuffer& imu, const NavState& from, TimeNs to, const LioConfig& config, const ImuNoise& noise) {
  Step step;
  if (to <= from.stamp) return step;
  step.samples = imu.between(from.stamp, to);
  const ImuRange range{config.imu.gyro_range, config.imu.accel_range};
  NavState nav = from;
  for (std::size_t i = 1; i < step.samples.size(); ++i) {
    const ImuSample &begin = step.samples[i - 1], &end = step.samples[i];
    const ImuInterval interval = mean_interval(nav, begin, end);
    const DiscreteModel model =
        discretize(nav, interval, noise_between(noise, range, begin, end, interval.dt), config.imu.discretization);
    step.phi = model.phi * step.phi;
    step.q = model.phi * step.q * model.phi.transpose() + model.q;
    nav = propagate_mean(nav, interval, noise);
  }
  return step;
}

struct Prediction {
  NavState nav;
  NavMatrix covariance;
};

void advance(const Step& step, const ImuNoise& noise, Prediction& prediction) {
  for (std::size_t i = 1; i < step.samples.size(); ++i)
    prediction.nav =
        propagate_mean(prediction.nav, mean_interval(prediction.nav, step.samples[i - 1], step.samples[i]), noise);
  prediction.covariance = step.phi * prediction.covariance * step.phi.transpose() + step.q;
}

struct Misfit {
  double nll = 0.0, nis = 0.0;
  int dof = 0;
};

/// Of the estimate against its prediction of `seconds` ago.
Misfit misfit_of(const Prediction& prediction, const NavState& estimate, const NavMatrix& covariance,
                 const Localizability& localizability, double seconds) {
  PoseVector to_metres = PoseVector::Ones();
  to_metres.head<3>().setConstant(localizability.scale);
  const PoseMatrix& x = localizability.directions;
  const PoseMatrix to_y = x.inverse() * to_metres.asDiagonal();
  const PoseVector error_y = to_y * nav_minus(estimate, prediction.nav).head<6>();
  const PoseMatrix predicted_y = to_y * prediction.covariance.topLeftCorner<6, 6>() * to_y.transpose();
  const PoseMatrix known_y = to_y * covariance.topLeftCorner<6, 6>() * to_y.transpose();

  Misfit misfit;
  int supported[6];
  for (int k = 0; k < 6; ++k)
    if (localizability.support[k] >= kSupported) supported[misfit.dof++] = k;
  if (misfit.dof == 0) return misfit;
  Eigen::VectorXd error(misfit.dof);
  Eigen::MatrixXd predicted(misfit.dof, misfit.dof), known(misfit.dof, misfit.dof), axes(6, misfit.dof);
  for (int i = 0; i < misfit.dof; ++i) {
    error[i] = error_y[supported[i]];
    axes.col(i) = x.col(supported[i]);
    for (int j = 0; j < misfit.dof; ++j) {
      predicted(i, j) = predicted_y(supported[i], supported[j]);
      known(i, j) = known_y(supported[i], supported[j]);
    }
  }
  // Whitened by the prediction's covariance the difference of the two is 1 - known.
  const Eigen::LLT<Eigen::MatrixXd> root(predicted);
  const auto lower = root.matrixL();
  const Eigen::MatrixXd half = lower.solve(known), whitened_known = lower.solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(Eigen::MatrixXd::Identity(misfit.dof, misfit.dof) -
                                                              0.5 * (whitened_known + whitened_known.transpose()));
  const Eigen::ArrayXd gain = solver.eigenvalues().array().max(HorizonLikelihood::kLeastGain);
  const Eigen::VectorXd whitened = solver.eigenvectors().transpose() * lower.solve(error);
  misfit.nis = (whitened.array().square() / gain).sum();
  // The directions need not be orthogonal: their Gram matrix takes the volume to metres.
  const double log_det = gain.log().sum() + 2.0 * Eigen::MatrixXd(lower).diagonal().array().log().sum() +
                         std::log((axes.transpose() * axes).determinant());
  misfit.nll = 0.5 * (misfit.nis + log_det) + misfit.dof * (0.5 * kLog2Pi - std::log(seconds));
  return misfit;
}

/// Sums of a run and of its stretches.
class Sums {
 public:
  void add(const Misfit& misfit, std::size_t stretch) {
    constexpr double kWeight = 1.0 / kBeginsPerHorizon;
    if (misfit.dof == 0) return;
    const bool sane = std::isfinite(misfit.nll) && misfit.nll < HorizonLikelihood::kWorstHorizonNll;
    score_.nll += kWeight * (sane ? misfit.nll : HorizonLikelihood::kWorstHorizonNll);
    if (!std::isfinite(misfit.nis)) return;
    score_.nis += kWeight * misfit.nis;
    score_.dof += kWeight * misfit.dof;
    if (nis_.size() <= stretch) nis_.resize(stretch + 1), dof_.resize(stretch + 1);
    nis_[stretch] += kWeight * misfit.nis;
    dof_[stretch] += kWeight * misfit.dof;
  }

  HorizonScore finish() const {
    HorizonScore score = score_;
    if (nis_.size() < HorizonLikelihood::kFewestStretches || !(score.nis > 0.0)) return score;
    const double mean = score.nis / score.dof;
    double square = 0.0;
    for (std::size_t i = 0; i < nis_.size(); ++i) square += std::pow(nis_[i] - mean * dof_[i], 2);
    const double independent = 2.0 * mean * mean * score.dof;
    score.independent_share = square > independent ? independent / square : 1.0;
    return score;
  }

 private:
  HorizonScore score_;
  std::vector<double> nis_, dof_;  ///< by stretch
};

}  // namespace

void HorizonLikelihood::add(const LioResult& result) {
  entries_.push_back({result.state.nav, result.covariance.topLeftCorner<kNavDof, kNavDof>(), result.localizability,
                      result.outcome == ScanOutcome::kUpdated});
}

HorizonScore HorizonLikelihood::score(const std::vector<ImuSample>& imu, double accel_scale) const {
  ImuBuffer buffer;
  for (ImuSample sample : imu) {
    sample.accel *= accel_scale;
    buffer.push(sample);
  }
  if (buffer.empty() || entries_.size() < 2) return {};
  const ImuNoise noise = make_imu_noise(config_.imu.spec, config_.imu.scale, config_.imu.bias_model);
  std::vector<Step> steps(entries_.size());  // each leads to the entry of its index
  for (std::size_t i = 1; i < entries_.size(); ++i)
    steps[i] = make_step(buffer, entries_[i - 1].nav, entries_[i].nav.stamp, config_, noise);

  Sums sums;
  const auto since_start = [&](std::size_t i) { return seconds_between(entries_[0].nav.stamp, entries_[i].nav.stamp); };
  const double longest = *std::max_element(kHorizons.begin(), kHorizons.end());
  for (const double horizon : kHorizons) {
    double next_begin = 0.0;
    for (std::size_t begin = 0; begin + 1 < entries_.size(); ++begin) {
      if (!entries_[begin].updated || since_start(begin) < next_begin) continue;
      while (next_begin <= since_start(begin)) next_begin += horizon / kBeginsPerHorizon;
      Prediction prediction{entries_[begin].nav, entries_[begin].covariance};
      std::size_t end = begin;
      while (end + 1 < entries_.size() && since_start(end) - since_start(begin) < horizon)
        advance(steps[++end], noise, prediction);
      const double seconds = since_start(end) - since_start(begin);
      if (seconds < horizon) break;
      if (!entries_[end].updated) continue;
      const Entry& last = entries_[end];
      sums.add(misfit_of(prediction, last.nav, last.covariance, last.localizability, seconds),
               static_cast<std::size_t>(since_start(end) / longest));
    }
  }
  return sums.finish();
}

}  // namespace allan_lio
