// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/State.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/subscriber.h>
#include <sensor_msgs/Imu.h>

#include <atomic>
#include <thread>

#include "allan_lio/imu/state_propagator.h"
#include "allan_lio/ros/param_source.h"
#include "allan_lio/ros/recording_watch.h"
#include "allan_lio/ros/thread_priority.h"

namespace allan_lio {

/// Odometry at the rate of the IMU as a ROS node: what the node and the nodelet have in common. Takes the filter's
/// `state` and the IMU's topic of the configuration, and publishes `imu_odometry` with covariances. Its callbacks run
/// in a thread of its own with `realtime_priority`, so that a message waits neither for a scan nor for a worker.
/// Live parameters (multipliers, ranges, the longest gap) are the filter's: what is in force of them comes with every
/// state, so ~in_force has none of them, and one that is given to this node is warned of.
class ImuPropagator {
 public:
  /// Throws ConfigError.
  ImuPropagator(ros::NodeHandle handle, ros::NodeHandle private_handle);
  ~ImuPropagator();
  ImuPropagator(const ImuPropagator&) = delete;
  ImuPropagator& operator=(const ImuPropagator&) = delete;

 private:
  ImuPropagator(ros::NodeHandle handle, ros::NodeHandle private_handle, const NodeParameters& parameters);

  void spin();
  void on_state(const StateConstPtr& message);
  void on_imu(const sensor_msgs::ImuConstPtr& message);

  LioConfig config_;  ///< the multipliers in it are those of the last state
  RigidTransform T_base_imu_;
  StatePropagator propagator_;
  RecordingWatch watch_;
  ros::Publisher odometry_;
  ros::CallbackQueue queue_;
  ros::Subscriber state_subscriber_, imu_subscriber_;  // after the queue that they fill
  PollThreadPriority poll_priority_;
  std::atomic<bool> ended_{false};
  std::thread thread_;  // last: no callback before the rest is there
};

}  // namespace allan_lio
