// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// How the odometry starts: from the IMU alone, at the first pose, and from a distorted first scan.
#include <algorithm>
#include <cmath>

#include "allan_lio/imu/static_init.h"
#include "allan_lio/lio/bias_mean.h"
#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"
#include "odometry_impl.h"

namespace allan_lio {
namespace {

double square(double x) { return x * x; }

/// Of the x axis [rad]; 0 where it is vertical.
double heading_of(const RigidTransform& T_world_imu) {
  const Eigen::Vector3d x = T_world_imu.rotation * Eigen::Vector3d::UnitX();
  return x.head<2>().norm() < 1e-3 ? 0.0 : std::atan2(x.y(), x.x());
}

}  // namespace

std::vector<ImuSample> Odometry::Impl::scaled_record(TimeNs from, TimeNs until) const {
  const ImuBuffer& imu = synchronizer_.imu();
  std::vector<ImuSample> record = imu.between(from, std::min(until, std::max(imu.newest(), from + 1)));
  for (ImuSample& sample : record) {
    sample.gyro -= start_.gyro_bias;
    sample.accel = accel_scale_ * sample.accel - start_.accel_bias;
  }
  return record;
}

bool Odometry::Impl::settle_accel_scale(TimeNs from, TimeNs until) {
  const LioConfig::Imu& imu = config_.imu;
  accel_scale_ = 1.0;
  if (imu.accel_unit == AccelUnit::kG) accel_scale_ = imu.gravity;
  if (imu.accel_unit == AccelUnit::kAuto) accel_scale_ = detect_accel_scale(scaled_record(from, until), imu.gravity);
  return synchronizer_.set_accel_scale(accel_scale_) > 0;
}

bool Odometry::Impl::initialize_from_imu() {
  const Scan* first = synchronizer_.front();
  if (!first) {
    if (synchronizer_.ended()) synchronizer_.take();  // settles what waits
    return false;
  }
  const ImuBuffer& imu = synchronizer_.imu();
  const TimeNs start = first->begin();
  const TimeNs from = std::max(imu.oldest(), start - to_ns(config_.init.standstill_time));
  const TimeNs until = from + to_ns(config_.init.standstill_time);
  if (imu.newest() < until && !synchronizer_.ended()) return false;

  if (settle_accel_scale(from, until)) return initialize_from_imu();  // the data may begin or end elsewhere now
  std::vector<ImuSample> record = scaled_record(from, until);
  const InitOptions options{config_.imu.gravity, config_.init.gyro_still, config_.init.accel_still,
                            config_.init.velocity_sigma, config_.init.moving_accel_sigma};
  quiet_start_ = is_still(record, start_.spec, options);
  standstill_.end();
  // Not where the pose of the start is itself uncertain: of a standstill only the relative pose is known.
  if (quiet_start_ && config_.init.hold_standstill && !start_.again && !config_.estimate_extrinsics)
    standstill_.begin(record, config_.imu.spec);
  if (!quiet_start_) {  // what the tilt is taken from must lie at the start, not a second before it
    const TimeNs last = std::max(imu.oldest(), start - to_ns(config_.init.moving_time));
    record = scaled_record(last, last + to_ns(config_.init.moving_time));
  }
  const InitialState initial = initialize(record, quiet_start_, start_.spec, noise_, options);
  state_.nav = initial.state;
  state_.nav.gyro_bias += start_.gyro_bias;
  state_.nav.accel_bias += start_.accel_bias;
  state_.nav.stamp = started_at_ = start;
  state_.nav.gyro_bias_mean = start_.gyro_bias;
  state_.nav.accel_bias_mean = start_.accel_bias;
  InertialMatrix covariance = InertialMatrix::Zero();
  covariance.topLeftCorner<kNavDof, kNavDof>() = initial.covariance;
  split_biases(start_.spec, noise_, state_.nav, covariance);
  belief_.covariance.topLeftCorner<kInertialDof, kInertialDof>() = covariance;
  if (config_.estimate_extrinsics) {
    belief_.covariance.diagonal().segment<3>(kExtrinsicRotation).setConstant(square(config_.extrinsic_rotation_sigma));
    belief_.covariance.diagonal()
        .segment<3>(kExtrinsicTranslation)
        .setConstant(square(config_.extrinsic_translation_sigma));
  }
  initialized_ = true;
  return true;
}

void Odometry::Impl::make_first_pose() {
  NavState& nav = state_.nav;
  const double turn_by = heading_of(start_.T_world_imu) - heading_of(nav.T_world_imu);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(turn_by, Eigen::Vector3d::UnitZ()));
  const Eigen::Matrix3d turn_matrix = turn.toRotationMatrix();
  LioMatrix turned = LioMatrix::Identity();
  turned.block<3, 3>(kPosition, kPosition) = turn_matrix;
  turned.block<3, 3>(kVelocity, kVelocity) = turn_matrix;
  turned.block<2, 2>(kGravity, kGravity) =
      s2_basis(turn * nav.gravity_world).transpose() * turn_matrix * s2_basis(nav.gravity_world);
  belief_.covariance = turned * belief_.covariance * turned.transpose();
  nav.T_world_imu.rotation = (turn * nav.T_world_imu.rotation).normalized();
  nav.T_world_imu.translation = start_.T_world_imu.translation;
  nav.velocity_world = turn * nav.velocity_world;
  nav.gravity_world = turn * nav.gravity_world;
  first_pose_ = nav.T_world_imu;
  anchor_pose();
  reset_absolute();
}

void Odometry::Impl::anchor_pose() {
  // In the world turned by R_hat R^T the pose is R_hat; to first order v turns by -R dtheta, and so does g.
  const Eigen::Matrix3d rotation = state_.nav.T_world_imu.rotation.toRotationMatrix();
  LioMatrix turn = LioMatrix::Identity();
  turn.block<3, 3>(kVelocity, kTheta) = skew(state_.nav.velocity_world) * rotation;
  turn.block<2, 3>(kGravity, kTheta) = -s2_basis(state_.nav.gravity_world).transpose() * rotation;
  belief_.covariance = turn * belief_.covariance * turn.transpose();
  belief_.view = ViewError{};
  belief_.covariance.topRows<6>().setZero();
  belief_.covariance.leftCols<6>().setZero();
  if (config_.estimate_extrinsics) anchor_lidar_pose();
}

void Odometry::Impl::anchor_lidar_pose() {
  // The IMU's pose errs by what cancels the extrinsics' error in the LiDAR's pose; v and g turn along.
  const Eigen::Matrix3d rotation = state_.nav.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix<double, 6, 6> pose = -lidar_pose_rows(state_, true).rightCols<6>();
  LioMatrix turn = LioMatrix::Identity();
  turn.block<6, 6>(kTheta, kExtrinsicRotation) = pose;
  turn.block<3, 6>(kVelocity, kExtrinsicRotation) = -skew(state_.nav.velocity_world) * rotation * pose.topRows<3>();
  turn.block<2, 6>(kGravity, kExtrinsicRotation) =
      s2_basis(state_.nav.gravity_world).transpose() * rotation * pose.topRows<3>();
  belief_.covariance = turn * belief_.covariance * turn.transpose();
}

void Odometry::Impl::settle_standstill() {
  LioState start = state_;
  start.nav.T_world_imu = first_pose_;
  if (contradicts_standstill(registered_points_, start, *map_, residual_options(config_), residuals_)) {
    standstill_.end();
    return;
  }
  update_zero_velocity(config_.init.still_velocity_sigma, state_, belief_.covariance);
  reset_absolute();  // of the map there is one scan, from a pose with the error that the start left
  if (start_.again) absolute_.remember(state_, config_.estimate_extrinsics);
}

bool Odometry::Impl::hold_standstill() {
  if (!standstill_.lasts() || scans_processed_ < kSettlingScans) return false;
  if (state_.nav.stamp < standstill_.recorded_until()) return false;
  if (!update_standstill(first_pose_, !held_, state_, belief_, absolute_)) standstill_.end();
  held_ = standstill_.lasts();
  return held_;
}

bool Odometry::Impl::is_distorted(const Scan& scan, const Eigen::Vector3d& predicted_velocity) const {
  if (scans_processed_ > kSettlingScans) return false;
  const double smear =
      (state_.nav.velocity_world - predicted_velocity).norm() * seconds_between(scan.begin(), scan.end());
  return smear > config_.lidar.range_noise;
}

void Odometry::Impl::found_map_again(const Scan& scan, std::vector<TrackSegment> track) {
  // The posterior's velocity, carried back over the scan by the same readings.
  const NavState& now = state_.nav;
  const NavState predicted = propagate_mean(track.back().start, track.back().interval, noise_);
  const Eigen::Vector3d wrong_by = predicted.velocity_world - now.velocity_world;
  for (TrackSegment& segment : track) segment.start.velocity_world -= wrong_by;
  NavState reference = track.front().start;
  for (std::size_t i = 0; i < track.size(); ++i) {
    track[i].start.T_world_imu = reference.T_world_imu;
    reference = propagate_mean(track[i].start, track[i].interval, noise_);
  }
  deskewer_ = make_deskewer(scan, track, reference);
  deskew_points(scan);
  clear_map();
  anchor_pose();
  reset_absolute();
}

}  // namespace allan_lio
