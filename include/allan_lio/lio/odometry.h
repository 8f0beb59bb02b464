// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/lidar/scan.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// A point of the map or of a deskewed scan, in the world frame.
struct WorldPoint {
  float x, y, z;    ///< [m]
  float intensity;  ///< as the driver gives it; 0 for map points
};

/// A pose in the world that is known from elsewhere. The filter's world is level, so of the attitude only the heading
/// counts: that of the x axis.
struct PoseAnchor {
  RigidTransform T_world_imu;
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Zero();  ///< [m^2], world
  double heading_variance = 0.0;                                  ///< about the world's z axis [rad^2]
};

/// LiDAR-inertial odometry: samples and scans in, states out. Deterministic: the results depend only on the two
/// streams, not on how they interleave, on the number of threads or on time. Not thread-safe.
class Odometry {
 public:
  explicit Odometry(const LioConfig& config);
  ~Odometry();

  /// Samples and scans must each come in the order of time; the two streams may interleave in any way.
  void add_imu(const ImuSample& sample);
  /// A scan from thin_scan() by the configuration's map.insert_leaf and lidar.leaf gives the same results as the whole.
  void add_scan(Scan scan);

  /// Says that no more data comes: the scans that still wait for IMU data are settled by next().
  void end_of_data();

  /// Processes the oldest scan whose IMU data is complete. Call it until it gives nothing.
  std::optional<LioResult> next();

  /// The last processed scan's points, deskewed, in the world frame.
  std::vector<WorldPoint> deskewed_points() const;

  /// The map's points or plane centres, in the world frame.
  std::vector<WorldPoint> map_points() const;

  double map_megabytes() const;
  std::size_t map_voxels() const;
  const LioCounters& counters() const;
  const LioConfig& config() const;

  /// Factor from the accelerometer's readings to m/s^2 in force; 1 before the start is settled.
  double accel_scale() const;

  /// Takes effect with the next scan. `config` may differ from the one in force in live parameters only
  /// (change_live()).
  void reconfigure(const LioConfig& config);

  /// Says where the IMU stood at the end of the last scan. The map starts anew there with that scan's points; velocity,
  /// biases and tilt stay as they are known. Before the first scan: where the run begins.
  void set_pose(const PoseAnchor& anchor);

  /// Forgets everything but the configuration in force and the counters, and starts again with the data to come.
  void restart();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace allan_lio
