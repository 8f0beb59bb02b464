// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/Finish.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/subscriber.h>
#include <ros/wall_timer.h>
#include <sensor_msgs/Imu.h>
#include <topic_tools/shape_shifter.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/ros/lio_monitor.h"
#include "allan_lio/ros/lio_services.h"
#include "allan_lio/ros/lio_session.h"
#include "allan_lio/ros/live_tuning.h"
#include "allan_lio/ros/param_source.h"
#include "allan_lio/ros/publish.h"

namespace allan_lio {

/// The filter as a ROS node: what the node and the nodelet have in common. Its callbacks must not run at the same
/// time, as they don't in a node that spins in one thread and in a nodelet's single-threaded queue. The latter also
/// calls nothing before onInit() is done, and holds the nodelet while it calls: whoever lets go of it meanwhile, it is
/// deleted after the callback.
class LioWrapper {
 public:
  /// Throws ConfigError, or std::runtime_error if ~out cannot be written.
  LioWrapper(ros::NodeHandle handle, ros::NodeHandle private_handle);

  /// Completes the files of a run that was interrupted, and logs it if they could not be written.
  ~LioWrapper();
  LioWrapper(const LioWrapper&) = delete;
  LioWrapper& operator=(const LioWrapper&) = delete;

 private:
  void on_imu(const sensor_msgs::ImuConstPtr& message);
  void on_cloud(const topic_tools::ShapeShifter::ConstPtr& message);
  void on_result(const LioResult& result);
  void start_again();
  void on_map_timer(const ros::WallTimerEvent&);
  bool on_finish(Finish::Request& request, Finish::Response& response);
  /// Settles everything and completes the files, once.
  void finish(const Finish::Request& request);
  void tell_news();

  NodeParameters parameters_;
  RigidTransform T_base_imu_;
  std::unique_ptr<LioPublisher> publisher_;
  std::unique_ptr<LioSession> session_;
  std::unique_ptr<LioMonitor> monitor_;
  std::unique_ptr<LiveTuning> tuning_;
  std::unique_ptr<LioServices> services_;
  std::optional<Eigen::Quaterniond> R_world_imu_;  ///< of the last result
  std::uint64_t imu_received_ = 0, scans_received_ = 0;
  std::string told_verdict_;
  bool told_noise_ = false;
  std::size_t told_remarks_ = 0;
  std::uint64_t told_restarts_ = 0;
  std::string told_relocated_;
  bool told_output_trouble_ = false;
  std::vector<std::uint8_t> cloud_bytes_;
  bool finished_ = false;
  std::string trouble_;  ///< why the results are not complete

  ros::WallTimer map_timer_;
  ros::ServiceServer finish_service_;
  // Last, so that no callback comes before the rest is there or after it has gone.
  ros::Subscriber imu_subscriber_, lidar_subscriber_;
};

}  // namespace allan_lio
