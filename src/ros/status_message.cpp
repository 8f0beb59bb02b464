// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/status_message.h"

#include <boost/make_shared.hpp>

#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

static_assert(Status::OK == static_cast<int>(HealthLevel::kOk) &&
                  Status::WARN == static_cast<int>(HealthLevel::kWarn) &&
                  Status::ERROR == static_cast<int>(HealthLevel::kError),
              "Status.msg names the levels in the order of HealthLevel");

geometry_msgs::Vector3 sigma_of(const LioMatrix& covariance, int index) {
  return to_vector(covariance.diagonal().segment<3>(index).cwiseMax(0.0).cwiseSqrt());
}

void put_scan(const LioResult& result, const HealthWindow& window, Status& message) {
  message.outcome = static_cast<std::uint8_t>(result.outcome);
  message.points = static_cast<std::uint32_t>(result.points);
  message.registered = static_cast<std::uint32_t>(result.registered);
  message.inliers = static_cast<std::uint32_t>(result.inliers);
  message.residual_rms = result.residual_rms;
  message.nis = result.innovation.nis;
  message.nis_dof = static_cast<std::uint32_t>(result.innovation.dof);
  const NisWindow nis = window.nis();
  message.nis_scans = static_cast<std::uint32_t>(nis.scans);
  message.nis_mean = nis.mean;
  message.nis_low = nis.low;
  message.nis_high = nis.high;
  Eigen::Map<PoseVector>(message.support.data()) = result.localizability.support;
  Eigen::Map<PoseVector>(message.probability.data()) = result.localizability.probability;
  message.weak_axes = static_cast<std::uint32_t>(weak_axes(result.localizability));
}

void put_configuration(const LioConfig& config, Status& message) {
  message.map_max_mb = config.map.max_mb;
  message.k_g = config.imu.scale.k_g;
  message.k_a = config.imu.scale.k_a;
  message.k_gb = config.imu.scale.k_gb;
  message.k_ab = config.imu.scale.k_ab;
  message.k_r = config.lidar.k_r;
}

}  // namespace

StatusPtr to_status_message(const LioResult& result, const LioSession& session, const HealthWindow& window,
                            const LostOnTheWay& lost, double delay) {
  auto message = boost::make_shared<Status>();
  const Odometry& odometry = session.odometry();
  const NavState& nav = result.state.nav;
  message->header.stamp = to_ros_time(nav.stamp);
  message->header.frame_id = odometry.config().frames.odom;
  put_scan(result, window, *message);
  put_configuration(odometry.config(), *message);
  message->config_hash = session.config_hash();
  message->gyro_bias = to_vector(nav.gyro_bias);
  message->gyro_bias_sigma = sigma_of(result.covariance, kGyroBias);
  message->accel_bias = to_vector(nav.accel_bias);
  message->accel_bias_sigma = sigma_of(result.covariance, kAccelBias);
  message->delay = delay;
  message->scan_time = session.scan_seconds();
  message->scan_time_mean = window.mean_seconds();
  message->map_mb = odometry.map_megabytes();
  message->map_voxels = static_cast<std::uint32_t>(odometry.map_voxels());
  for (const LossCount& loss : count_losses(odometry.counters(), session.undecodable(), lost)) {
    message->dropped.emplace_back();
    message->dropped.back().reason = loss.reason;
    message->dropped.back().count = loss.count;
  }
  return message;
}

}  // namespace allan_lio
