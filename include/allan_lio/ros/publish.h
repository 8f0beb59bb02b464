// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nav_msgs/Path.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/transform_broadcaster.h>

#include "allan_lio/ros/lio_session.h"

namespace allan_lio {

/// ~odometry, ~path, ~points, ~map, ~markers, ~state and TF of the filter. Nothing with NaN or inf in it is published.
class LioPublisher {
 public:
  LioPublisher(ros::NodeHandle private_handle, const LioConfig& config, const RigidTransform& T_base_imu);

  void publish(const LioResult& result, const LioSession& session);

  /// Publishes the map if it is wanted and has grown since.
  void publish_map(const LioSession& session);

  /// The estimator starts again: so does the path.
  void clear_path() { track_.poses.clear(); }

 private:
  void extend_path(const LioResult& result);

  LioConfig config_;
  RigidTransform T_base_imu_;
  ros::Publisher odometry_, path_, points_, map_, state_, markers_;
  tf2_ros::TransformBroadcaster transforms_;
  nav_msgs::Path track_;
  TimeNs newest_ = 0;     ///< stamp of the last result
  TimeNs map_stamp_ = 0;  ///< of the map last published
};

/// T_base_imu: the configuration's, or from TF if frames/extrinsics_from_tf is set, which then also sets both
/// extrinsics in `config`. Waits for TF at most `patience` [s], then throws ConfigError naming the frames.
RigidTransform resolve_extrinsics(LioConfig& config, double patience);

/// Variance of one gyro reading's white noise in the IMU's band: N_g^2 over the sample interval [(rad/s)^2].
Eigen::Vector3d gyro_reading_variance(const LioConfig::Imu& imu, double sample_interval);

}  // namespace allan_lio
