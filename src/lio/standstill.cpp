// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/standstill.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "allan_lio/imu/interval_noise.h"

namespace allan_lio {
namespace {

constexpr double kMostNoise = 3.0;      // times the specification's, of a reading
constexpr double kMostSigma = 5.0;      // of a mean's deviation
constexpr double kWindow = 0.1;         // [s] over which means are taken
constexpr double kLongestMean = 10.0;   // [s], as biases drift
constexpr double kRotation = 1e-4;      // [rad] by which what stands sways, anew at each scan
constexpr double kTranslation = 1e-3;   // [m]
constexpr double kVelocitySway = 2e-3;  // [m/s]
constexpr double kKnownVelocity = 0.1;  // [m/s]
constexpr double kLargest = 33.7;       // chi^2 with 9 degrees of freedom, 0.9999

}  // namespace

void Standstill::begin(const std::vector<ImuSample>& record, const NoiseSpec& spec) {
  const auto readings = [](const ImuSample& s) {
    Readings out;
    out << s.gyro.array(), s.accel.array();
    return out;
  };
  mean_.setZero();
  for (const ImuSample& s : record) mean_ += readings(s);
  mean_ /= static_cast<double>(record.size());
  Readings squares = Readings::Zero(), white;
  for (const ImuSample& s : record) squares += (readings(s) - mean_).square();
  white << spec.gyro.white.array().square(), spec.accel.white.array().square();
  seconds_ = seconds_between(record.front().stamp, record.back().stamp);
  const double samples = static_cast<double>(record.size() - 1);
  const Readings found = squares / samples * (seconds_ / samples);
  lasts_ = seconds_ > 0.0 && (found < kMostNoise * kMostNoise * white).all();
  psd_ = found.max(white);
  recorded_until_ = record.back().stamp;
}

void Standstill::go_on(const std::vector<TrackSegment>& track) {
  if (!lasts_) return;
  double whole = 0.0;
  for (const TrackSegment& segment : track) {
    if (segment.interval.dt > kImuGap) return end();
    whole += segment.interval.dt;
  }
  // A motion that came and went within the time of several scans must not average out.
  const double window = whole / std::max(1.0, std::round(whole / kWindow));
  Readings sum = Readings::Zero();
  double seconds = 0.0;
  for (const TrackSegment& segment : track) {
    const double dt = segment.interval.dt;
    sum.head<3>() += dt * (segment.interval.gyro + segment.start.gyro_bias).array();
    sum.tail<3>() += dt * (segment.interval.accel + segment.start.accel_bias).array();
    seconds += dt;
    if (seconds < window - 0.5 * dt) continue;
    compare(sum / seconds, seconds);
    sum.setZero();
    seconds = 0.0;
  }
  if (seconds > 0.0) compare(sum / seconds, seconds);
}

void Standstill::compare(const Readings& mean, double seconds) {
  const Readings deviation = mean - mean_;
  if ((deviation.square() > kMostSigma * kMostSigma * psd_ * (1.0 / seconds + 1.0 / seconds_)).any()) return end();
  seconds_ = std::min(seconds_, kLongestMean) + seconds;
  mean_ += seconds / seconds_ * deviation;
}

bool update_standstill(const RigidTransform& pose, bool first, LioState& state, Belief& belief,
                       AbsoluteCovariance& absolute) {
  constexpr int kSeen = 9;  // attitude, position and velocity come first
  using SeenVector = Eigen::Matrix<double, kSeen, 1>;
  NavState still = state.nav;
  still.T_world_imu = pose;
  still.velocity_world.setZero();
  if (belief.covariance.diagonal().segment<3>(kVelocity).maxCoeff() > kKnownVelocity * kKnownVelocity) return false;
  const SeenVector innovation = nav_minus(still, state.nav).head<kSeen>();
  SeenVector variances;
  variances << Eigen::Vector3d::Constant(kRotation * kRotation), Eigen::Vector3d::Constant(kTranslation * kTranslation),
      Eigen::Vector3d::Constant(kVelocitySway * kVelocitySway);
  Eigen::Matrix<double, kSeen, kSeen> expected = belief.covariance.topLeftCorner<kSeen, kSeen>();
  expected.diagonal() += variances;
  const Eigen::LDLT<Eigen::Matrix<double, kSeen, kSeen>> solver(expected);
  if (innovation.dot(solver.solve(innovation)) > kLargest) return false;

  Eigen::Matrix<double, kLioDof, kSeen> gain = Eigen::Matrix<double, kLioDof, kSeen>::Identity();
  if (!first) gain = solver.solve(belief.covariance.topRows<kSeen>()).transpose();
  const LioState updated = lio_plus(state, gain * innovation);
  LioMatrix left = LioMatrix::Identity();
  left.leftCols<kSeen>() -= gain;
  const LioMatrix reset = transport(updated, state);
  left = (reset * left).eval();
  const Eigen::Matrix<double, kLioDof, kSeen> carried = reset * gain;
  const LioMatrix noise = carried * variances.asDiagonal() * carried.transpose();
  const LioMatrix posterior = left * belief.covariance * left.transpose() + noise;
  belief.covariance = 0.5 * (posterior + posterior.transpose());
  belief.view.cross = (left * belief.view.cross).eval();
  absolute.transform(left);
  absolute.add(noise);
  state = updated;
  return true;
}

}  // namespace allan_lio
