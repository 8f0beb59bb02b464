// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/State.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/Imu.h>

#include "allan_lio/imu/state_propagator.h"
#include "allan_lio/ros/param_source.h"

namespace allan_lio {

/// Odometry at the rate of the IMU as a ROS node: what the node and the nodelet have in common. Takes the filter's
/// `state` and the IMU's topic of the configuration, and publishes `imu_odometry` with covariances. Its callbacks
/// must not run at the same time.
class ImuPropagator {
 public:
  /// Throws ConfigError.
  ImuPropagator(ros::NodeHandle handle, ros::NodeHandle private_handle);

 private:
  void on_state(const StateConstPtr& message);
  void on_imu(const sensor_msgs::ImuConstPtr& message);

  LioConfig config_;
  RigidTransform T_base_imu_;
  StatePropagator propagator_;
  double sample_interval_ = 0.0;  ///< between the last two samples [s]
  TimeNs last_imu_ = 0;
  ros::Publisher odometry_;
  // Last, so that no callback comes before the rest is there or after it has gone.
  ros::Subscriber state_subscriber_, imu_subscriber_;
};

}  // namespace allan_lio
