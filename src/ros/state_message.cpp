// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/state_message.h"

#include <boost/make_shared.hpp>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

constexpr int kToldDof = kNavDof + 6;  // all but what the biases decay to
using RowMajor = Eigen::Matrix<double, kToldDof, kToldDof, Eigen::RowMajor>;
static_assert(State::_covariance_type::static_size == kToldDof * kToldDof, "State.msg holds the covariance");
static_assert(State::UPDATED == static_cast<int>(ScanOutcome::kUpdated) &&
                  State::FIRST == static_cast<int>(ScanOutcome::kFirst) &&
                  State::TOO_FEW_POINTS == static_cast<int>(ScanOutcome::kTooFewPoints) &&
                  State::TOO_FEW_MATCHES == static_cast<int>(ScanOutcome::kTooFewMatches) &&
                  State::MAP_RESTARTED == static_cast<int>(ScanOutcome::kMapRestarted),
              "State.msg names the outcomes in the order of ScanOutcome");

RowMajor told_covariance(const LioMatrix& covariance) {
  RowMajor told;
  told << covariance.topLeftCorner<kNavDof, kNavDof>(), covariance.topRightCorner<kNavDof, 6>(),
      covariance.bottomLeftCorner<6, kNavDof>(), covariance.bottomRightCorner<6, 6>();
  return told;
}

}  // namespace

StatePtr to_state_message(const LioResult& result, const LioSession& session) {
  auto message = boost::make_shared<State>();
  const LioConfig& config = session.odometry().config();
  const NavState& nav = result.state.nav;
  message->header.stamp = to_ros_time(nav.stamp);
  message->header.frame_id = config.frames.odom;
  message->child_frame_id = config.frames.imu;
  message->position = to_point(nav.T_world_imu.translation);
  message->orientation = to_quaternion(nav.T_world_imu.rotation);
  message->velocity = to_vector(nav.velocity_world);
  message->angular_velocity = to_vector(result.gyro);
  message->gyro_bias = to_vector(nav.gyro_bias);
  message->accel_bias = to_vector(nav.accel_bias);
  message->gravity = to_vector(nav.gravity_world);
  message->extrinsic_translation = to_point(result.state.T_imu_lidar.translation);
  message->extrinsic_rotation = to_quaternion(result.state.T_imu_lidar.rotation);
  Eigen::Map<RowMajor>(message->covariance.data()) = told_covariance(result.covariance);
  message->outcome = static_cast<std::uint8_t>(result.outcome);
  message->points = static_cast<std::uint32_t>(result.points);
  message->registered = static_cast<std::uint32_t>(result.registered);
  message->inliers = static_cast<std::uint32_t>(result.inliers);
  message->iterations = static_cast<std::uint32_t>(result.iterations);
  message->residual_rms = result.residual_rms;
  Eigen::Map<PoseVector>(message->support.data()) = result.localizability.support;
  Eigen::Map<PoseVector>(message->probability.data()) = result.localizability.probability;
  // A column after the other: each becomes a row of the message.
  Eigen::Map<PoseMatrix>(message->directions.data()) = unscaled_directions(result.localizability);
  message->k_g = config.imu.scale.k_g;
  message->k_a = config.imu.scale.k_a;
  message->k_gb = config.imu.scale.k_gb;
  message->k_ab = config.imu.scale.k_ab;
  message->k_r = config.lidar.k_r;
  message->config_hash = session.config_hash();
  message->accel_scale = session.odometry().accel_scale();
  message->gyro_range = config.imu.gyro_range;
  message->accel_range = config.imu.accel_range;
  message->max_gap = config.imu.max_gap;
  return message;
}

NavState nav_state_of(const State& message) {
  NavState nav;
  nav.stamp = to_time_ns(message.header.stamp);
  nav.T_world_imu = {from_quaternion(message.orientation).normalized(), from_point(message.position)};
  nav.velocity_world = from_vector(message.velocity);
  nav.gyro_bias = from_vector(message.gyro_bias);
  nav.accel_bias = from_vector(message.accel_bias);
  nav.gravity_world = from_vector(message.gravity);
  return nav;
}

NavMatrix nav_covariance_of(const State& message) {
  return Eigen::Map<const RowMajor>(message.covariance.data()).topLeftCorner<kNavDof, kNavDof>();
}

}  // namespace allan_lio
