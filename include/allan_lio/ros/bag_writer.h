// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/trajectory.h"

namespace rosbag {
class Bag;
}

namespace allan_lio {

/// Writes simulated data as a ROS driver would: /points (sensor_msgs/PointCloud2 in Velodyne's XYZIRT layout, frame
/// lidar), /imu/data or another topic (sensor_msgs/Imu, frame imu) and /ground_truth/odometry (nav_msgs/Odometry,
/// world -> imu). The calls must come in the order of time.
class BagWriter {
 public:
  /// Throws rosbag::BagException if the file cannot be made; so do the others if it cannot be written.
  explicit BagWriter(const std::string& path);
  ~BagWriter();

  /// Stamped with the sweep's begin, recorded at its end, when a driver would hand it out.
  void write_points(const SimSweep& sweep);
  void write_imu(const ImuSample& sample, const std::string& topic = "/imu/data");
  void write_odometry(TimeNs stamp, const MotionState& state);

  void close();

 private:
  std::unique_ptr<rosbag::Bag> bag_;
};

}  // namespace allan_lio
