// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/Finish.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_client.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "allan_lio/ros/bag_laps.h"

namespace allan_lio {

/// Publishes recorded messages for the filter, no faster than it takes them: it asks the filter's ~finish service
/// how far it has come, and never lets more be under way than the filter's queues hold.
class BagPlayer {
 public:
  struct Options {
    std::string filter = "lidar_odometry";  ///< name of the filter's node or nodelet
    double rate = 0.0;                      ///< times real time, without gaps of over an hour; 0: unbounded
    double patience = 30.0;                 ///< how long to wait for the filter [s]
    std::uint64_t laps = 1;                 ///< how often the bags are played, see BagLaps
  };

  /// Throws BagError or std::runtime_error with a sentence.
  BagPlayer(const std::vector<std::string>& bags, const Options& options);

  /// Plays everything, has the filter write its results and throws std::runtime_error with a sentence if they are
  /// not complete. Returns early, without an error, if ROS shuts down.
  void play();

  std::uint64_t imu_sent() const { return imu_sent_; }
  std::uint64_t scans_sent() const { return scans_sent_; }

 private:
  void wait_for_filter(double patience);
  void advertise(const BagConnection& connection);
  void wait_for_subscriptions(double patience);
  void pace(const ros::Time& time);
  void publish(const BagMessage& message);
  /// Waits until the filter has taken all but a few of what was sent.
  void hold();
  void finish();
  /// Asks the filter. Throws std::runtime_error if it has gone.
  Finish::Response ask(bool end);
  bool filter_subscribes(const std::string& topic);

  ros::NodeHandle handle_;
  BagLaps laps_;
  std::vector<std::string> files_;
  std::string filter_;
  double rate_;
  double patience_;  ///< [s]
  ros::ServiceClient service_;
  Finish::Response answer_;  ///< the last one

  std::map<std::string, std::set<std::string>> subscribers_;  ///< node names by topic, as they connect
  std::map<std::string, ros::Publisher> publishers_;
  ros::Publisher clock_;
  ros::Time begin_, last_, last_clock_;
  ros::WallTime wall_begin_;
  std::uint64_t imu_sent_ = 0, scans_sent_ = 0;
};

}  // namespace allan_lio
