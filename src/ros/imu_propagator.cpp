// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/imu_propagator.h"

#include <nav_msgs/Odometry.h>
#include <ros/console.h>

#include "allan_lio/io/live_parameters.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/finite.h"
#include "allan_lio/ros/publish.h"
#include "allan_lio/ros/state_message.h"

namespace allan_lio {
namespace {

constexpr double kTfPatience = 10.0;  // [s]
constexpr int kImuQueue = 4000;
constexpr int kStateQueue = 20;
const ros::WallDuration kLook(0.1);  // for the end

/// Names those of the given parameters that only the filter's own count for.
void warn_of_filters_parameters(const NodeParameters& parameters) {
  for (const ParameterEntry& entry : live_parameters(parameters.config)) {
    const auto given = parameters.given.find(entry.info.key);
    if (given != parameters.given.end())
      ROS_WARN_STREAM(entry.info.key << " (" << given->second.origin
                                     << ") has no effect on the odometry at the rate of the IMU, which takes what is "
                                        "in force from the filter's state: set it on the filter");
  }
}

}  // namespace

ImuPropagator::ImuPropagator(ros::NodeHandle handle, ros::NodeHandle private_handle)
    : ImuPropagator(handle, private_handle, read_node_parameters(private_handle)) {}

ImuPropagator::ImuPropagator(ros::NodeHandle handle, ros::NodeHandle private_handle, const NodeParameters& parameters)
    : config_(parameters.config),
      T_base_imu_(resolve_extrinsics(config_, kTfPatience)),
      propagator_({config_.imu.discretization, {config_.imu.gyro_range, config_.imu.accel_range}, config_.imu.max_gap}),
      odometry_(handle.advertise<nav_msgs::Odometry>("imu_odometry", 1000)),
      poll_priority_(config_.realtime_priority) {
  show_in_force(private_handle, fixed_parameters(config_));
  warn_of_filters_parameters(parameters);
  handle.setCallbackQueue(&queue_);
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  state_subscriber_ = handle.subscribe("state", kStateQueue, &ImuPropagator::on_state, this, hints);
  imu_subscriber_ = handle.subscribe(config_.topics.imu, kImuQueue, &ImuPropagator::on_imu, this, hints);
  thread_ = std::thread(&ImuPropagator::spin, this);
}

ImuPropagator::~ImuPropagator() {
  ended_ = true;
  thread_.join();
}

void ImuPropagator::spin() {
  const std::string hindered = set_thread_priority(0, config_.realtime_priority);
  if (!hindered.empty())
    ROS_WARN_STREAM("no real-time priority " << config_.realtime_priority << " (" << hindered
                                             << "): odometry at the rate of the IMU may wait some ms for a core; allow "
                                                "it by RLIMIT_RTPRIO, or set realtime_priority: 0");
  while (!ended_) queue_.callAvailable(kLook);
}

void ImuPropagator::on_state(const StateConstPtr& message) {
  if (!all_finite(*message)) return;
  config_.imu.scale = {message->k_g, message->k_a, message->k_gb, message->k_ab};
  propagator_.set_limits({message->gyro_range, message->accel_range}, message->max_gap);
  // Until the next state a bias is where it was: of its way back to its mean a scan's time is a hundredth at most.
  propagator_.restart(nav_state_of(*message), nav_covariance_of(*message),
                      make_imu_noise(config_.imu.spec, config_.imu.scale, BiasModel::kRandomWalk),
                      message->accel_scale);
}

void ImuPropagator::on_imu(const sensor_msgs::ImuConstPtr& message) {
  const ImuSample sample = to_imu_sample(*message);
  if (watch_.begins_anew(sample.stamp)) {
    propagator_.clear();
    watch_ = RecordingWatch();
  }
  if (!propagator_.add(sample)) return;
  BaseEstimate estimate;
  estimate.state = propagator_.estimate().state;
  estimate.covariance = propagator_.estimate().covariance;
  estimate.gyro = propagator_.estimate().gyro;
  estimate.gyro_variance = gyro_reading_variance(config_.imu, propagator_.sample_interval());
  estimate.T_base_imu = T_base_imu_;
  publish_finite(odometry_, to_odometry(estimate, config_.frames.odom, config_.frames.base));
}

}  // namespace allan_lio
