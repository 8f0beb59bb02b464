// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// How the odometry goes on when both sensors were silent for longer than can be bridged.
#include <algorithm>
#include <utility>

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"
#include "odometry_impl.h"

namespace allan_lio {
namespace {

constexpr double kTurnRate = 0.5;    // [rad/s] 1 sigma of how fast the sensor may have turned unseen
constexpr double kAnyHeading = 1.8;  // [rad] 1 sigma of a heading of which nothing is known: pi/sqrt(3)

double square(double x) { return x * x; }

/// The constant part of a bias as it is known at a new start.
struct BiasStart {
  Eigen::Vector3d value;    ///< [unit of the bias]
  Eigen::Vector3d turn_on;  ///< 1 sigma
};

/// Of a random walk what is left to know after `seconds`; a Gauss-Markov process has forgotten where it was and keeps
/// its mean.
BiasStart constant_part(const Eigen::Vector3d& bias, const Eigen::Vector3d& mean, const Eigen::Vector3d& variance,
                        const Eigen::Vector3d& mean_variance, const Eigen::Vector3d& psd, const Eigen::Vector3d& rate,
                        double seconds) {
  const auto walks = rate.array() == 0.0;
  return {walks.select(bias, mean), walks.select(variance + seconds * psd, mean_variance).cwiseSqrt()};
}

}  // namespace

ImuBuffer::Silence Odometry::Impl::blind_until(TimeNs t) const {
  return synchronizer_.imu().longest_silence(std::max(updated_at_, started_at_), t);
}

void Odometry::Impl::start_in_place(const ImuBuffer::Silence& silence, Scan scan) {
  ++counters_.starts_in_place;
  const LioMatrix& known = absolute_.state();
  const double blind = seconds_between(silence.begin, silence.end);
  const Eigen::Vector3d up = state_.nav.T_world_imu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  start_.again = true;
  start_.T_world_imu = state_.nav.T_world_imu;
  start_.position_covariance = known.block<3, 3>(kPosition, kPosition);
  start_.position_covariance.diagonal().array() += square(config_.init.velocity_sigma * blind);
  start_.heading_variance =
      up.dot(known.block<3, 3>(kTheta, kTheta) * up) + square(std::min(kTurnRate * blind, kAnyHeading));
  const NavState& nav = state_.nav;
  const auto variance = [&known](int index) { return Eigen::Vector3d(known.diagonal().segment<3>(index)); };
  const BiasStart gyro = constant_part(nav.gyro_bias, nav.gyro_bias_mean, variance(kGyroBias), variance(kGyroBiasMean),
                                       noise_.gyro_bias_psd, noise_.gyro_bias_rate, blind);
  const BiasStart accel = constant_part(nav.accel_bias, nav.accel_bias_mean, variance(kAccelBias),
                                        variance(kAccelBiasMean), noise_.accel_bias_psd, noise_.accel_bias_rate, blind);
  start_.gyro_bias = gyro.value;
  start_.accel_bias = accel.value;
  start_.spec.gyro.turn_on_bias = gyro.turn_on;
  start_.spec.accel.turn_on_bias = accel.turn_on;

  belief_ = Belief{};
  clear_map();
  map_proven_ = false;
  unmatched_in_a_row_ = scans_processed_ = 0;
  initialized_ = false;
  synchronizer_.begin_again(silence.end, std::move(scan));
}

void Odometry::Impl::reset_absolute() {
  LioMatrix covariance = belief_.covariance;
  if (start_.again) {
    const NavState& nav = state_.nav;
    const Eigen::Matrix3d to_body = nav.T_world_imu.rotation.conjugate().toRotationMatrix();
    // A heading error turns the attitude and the velocity along.
    LioVector by_heading = LioVector::Zero();
    by_heading.segment<3>(kTheta) = to_body.col(2);
    by_heading.segment<3>(kVelocity) = Eigen::Vector3d::UnitZ().cross(nav.velocity_world);
    covariance += start_.heading_variance * by_heading * by_heading.transpose();
    // What the start left unknown of the tilt stands in gravity's direction; in the run's world it is the attitude's.
    const Eigen::Matrix<double, 3, 2> by_gravity =
        to_body * skew(nav.gravity_world.normalized()) * s2_basis(nav.gravity_world);
    covariance.block<3, 3>(kTheta, kTheta) +=
        by_gravity * belief_.covariance.block<2, 2>(kGravity, kGravity) * by_gravity.transpose();
    covariance.block<3, 3>(kPosition, kPosition) += start_.position_covariance;
  }
  absolute_.reset(covariance);
}

}  // namespace allan_lio
