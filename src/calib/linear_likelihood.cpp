// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/linear_likelihood.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "allan_lio/lio/bias_mean.h"
#include "horizon_misfit.h"

namespace allan_lio {
namespace {

constexpr double kLog2Pi = 1.83787706640934548356;
constexpr double kLinearLeastGain = 0.01;  ///< a linear filter's two covariances are what they say: only for rounding

// The filter's state: the run's error, the view's, the map's drift (rotation and translation each).
constexpr int kView = kInertialDof, kDrift = kInertialDof + 6, kLinearDof = kInertialDof + 12;
using LinearMatrix = Eigen::Matrix<double, kLinearDof, kLinearDof>;
using LinearVector = Eigen::Matrix<double, kLinearDof, 1>;
using Gain = Eigen::Matrix<double, kLinearDof, Eigen::Dynamic, 0, kLinearDof, 6>;

double square(double x) { return x * x; }

class LinearFilter {
 public:
  LinearFilter(const LinearRun& run, const NoiseSetting& setting, const LidarErrors& errors)
      : run_(run),
        errors_(errors),
        noise_{square(setting.imu.k_g), square(setting.imu.k_a), square(setting.imu.k_gb), square(setting.imu.k_ab)},
        white_(square(errors.white * setting.k_r / run.k_r)) {
    p_.topLeftCorner<kInertialDof, kInertialDof>() = run.initial_covariance;
  }

  /// What the readings add to the covariance.
  NavMatrix noise_of(const LinearScan& scan) const {
    NavMatrix q = scan.bridged;
    for (std::size_t i = 0; i < noise_.size(); ++i) q += noise_[i] * scan.noise[i];
    return q;
  }

  void predict(const LinearScan& scan) {
    InertialVector x = x_.head<kInertialDof>();
    carry(scan.phi, x);
    x_.head<kInertialDof>() = x - scan.correction;
    x_.segment<6>(kView) *= scan.view_kept;
    InertialMatrix p = p_.topLeftCorner<kInertialDof, kInertialDof>();
    carry(scan.phi, p);
    p.topLeftCorner<kNavDof, kNavDof>() += noise_of(scan);
    p_.topLeftCorner<kInertialDof, kInertialDof>() = p;
    p_.topRightCorner<kInertialDof, 12>() = (with_bias_means(scan.phi) * p_.topRightCorner<kInertialDof, 12>()).eval();
    p_.block<kLinearDof, 6>(0, kView) *= scan.view_kept;
    p_.block<6, 6>(kView, kView) *= scan.view_kept;
    p_.block<6, 6>(kView, kView) += (1.0 - square(scan.view_kept)) * square(errors_.view) * scan.view_noise;
    p_.block<6, 6>(kView, kDrift) *= scan.view_kept;
    p_.bottomLeftCorner<12, kInertialDof>() = p_.topRightCorner<kInertialDof, 12>().transpose();
    p_.block<6, 6>(kDrift, kView) = p_.block<6, 6>(kView, kDrift).transpose();
    p_.diagonal().segment<3>(kDrift).array() += square(errors_.drift_rotation) * scan.step;
    p_.diagonal().segment<3>(kDrift + 3).array() += square(errors_.drift_position) * scan.step;
  }

  /// Adds to the score what the innovation says, if `counts`.
  void update(const LinearScan& scan, bool counts, LinearScore& score) {
    const auto rows = scan.rows.rows();
    if (rows == 0) return;
    Eigen::Matrix<double, Eigen::Dynamic, kLinearDof, 0, 6, kLinearDof> h(rows, kLinearDof);
    h.setZero();
    h.leftCols<6>() = scan.rows;
    h.middleCols<6>(kView) = -scan.rows;
    h.middleCols<6>(kDrift) = -scan.map_rows;
    Gain cross = p_ * h.transpose();
    SupportedMatrix s = h * cross;
    s.diagonal() += white_ * scan.variances;
    // Deskewing shifts the scan by n, of which T/2 of the gyro's density is in the state's error: deskewing_error().
    const auto turns = scan.rows.leftCols<3>();
    const Eigen::Vector3d density = noise_[0] * scan.deskewed * run_.gyro_psd;
    s += (1.0 / 3.0 - 1.0) * turns * density.asDiagonal() * turns.transpose();
    cross.topRows<3>() -= 0.5 * density.asDiagonal() * turns.transpose();

    const Eigen::LLT<SupportedMatrix> root(s);
    const SupportedVector innovation = scan.measured - h * x_;
    if (counts) {
      const double nis = SupportedVector(root.matrixL().solve(innovation)).squaredNorm();
      const double log_det = 2.0 * root.matrixLLT().diagonal().array().log().sum() + scan.log_gram;
      score.nis += nis;
      score.dof += static_cast<std::uint64_t>(rows);
      score.nll += 0.5 * (nis + log_det + static_cast<double>(rows) * kLog2Pi);
    }
    const Gain gain = root.solve(cross.transpose()).transpose();
    x_ += gain * innovation;
    const LinearMatrix updated = p_ - gain * cross.transpose();
    p_ = 0.5 * (updated + updated.transpose());
  }

  InertialVector error() const { return x_.head<kInertialDof>(); }
  InertialMatrix covariance() const { return p_.topLeftCorner<kInertialDof, kInertialDof>(); }

 private:
  const LinearRun& run_;
  const LidarErrors& errors_;
  const std::array<double, 4> noise_;  ///< k^2
  const double white_;                 ///< on the variances
  LinearVector x_ = LinearVector::Zero();
  LinearMatrix p_ = LinearMatrix::Zero();
};

/// The filter's states, and what the readings did between them.
struct Track {
  std::vector<double> times;
  std::vector<bool> updated;
  std::vector<InertialVector> errors;
  std::vector<InertialMatrix> covariances;
  std::vector<NavMatrix> noise;
};

HorizonScore score_horizons(const LinearRun& run, const Track& track) {
  HorizonSums sums;
  for_each_horizon(track.times, track.updated, [&](std::size_t begin, std::size_t end, double seconds) {
    InertialVector x = track.errors[begin];
    InertialMatrix p = track.covariances[begin];
    for (std::size_t i = begin + 1; i <= end; ++i) {
      const LinearScan& scan = run.scans[i];
      carry(scan.phi, x);
      x -= scan.correction;
      carry(scan.phi, p);
      p.topLeftCorner<kNavDof, kNavDof>() += track.noise[i];
    }
    const SupportedRows& rows = run.scans[end].rows;
    const auto along = [&rows](const InertialMatrix& covariance) {
      return SupportedMatrix(rows * covariance.topLeftCorner<6, 6>() * rows.transpose());
    };
    sums.add(horizon_misfit(rows * (track.errors[end] - x).head<6>(), along(p), along(track.covariances[end]),
                            run.scans[end].log_gram, seconds, kLinearLeastGain),
             track.times[end]);
  });
  return sums.finish();
}

}  // namespace

LinearScore score_linear(const LinearRun& run, const NoiseSetting& setting, const LidarErrors& errors,
                         bool with_horizons) {
  LinearScore score;
  LinearFilter filter(run, setting, errors);
  Track track;
  for (std::size_t i = 0; i < run.scans.size(); ++i) {
    const LinearScan& scan = run.scans[i];
    if (i > 0) filter.predict(scan);
    filter.update(scan, scan.time > kSettling, score);
    if (!with_horizons) continue;
    track.times.push_back(scan.time);
    track.updated.push_back(scan.rows.rows() > 0);
    track.errors.push_back(filter.error());
    track.covariances.push_back(filter.covariance());
    track.noise.push_back(i > 0 ? filter.noise_of(scan) : NavMatrix(NavMatrix::Zero()));
  }
  if (with_horizons) score.horizon = score_horizons(run, track);
  return score;
}

}  // namespace allan_lio
