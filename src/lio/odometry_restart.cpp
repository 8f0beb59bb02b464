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

/// What is left to know [unit of the bias] of a bias of covariance P after `seconds` of random walk.
Eigen::Vector3d left_to_know(const LioMatrix& P, int index, const Eigen::Vector3d& psd, double seconds) {
  return (P.diagonal().segment<3>(index) + seconds * psd).cwiseSqrt();
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
  start_.gyro_bias = state_.nav.gyro_bias;
  start_.accel_bias = state_.nav.accel_bias;
  start_.spec.gyro.turn_on_bias = left_to_know(known, kGyroBias, noise_.gyro_bias_psd, blind);
  start_.spec.accel.turn_on_bias = left_to_know(known, kAccelBias, noise_.accel_bias_psd, blind);

  belief_ = Belief{};
  map_->clear();
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
