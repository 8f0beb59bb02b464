// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace allan_lio {

/// What a user should know of the sensors' data, each thing said once.
class SensorRemarks {
 public:
  /// Of each message: the extrinsics are those of one sensor, so a frame that changes is suspect, and an empty one too.
  void imu_frame(const std::string& frame) { look(frame, "IMU", imu_); }
  void lidar_frame(const std::string& frame) { look(frame, "LiDAR", lidar_); }

  /// Factor from the accelerometer's readings to m/s^2, once it is known.
  void accel_scale(double scale);

  const std::vector<std::string>& sentences() const { return sentences_; }

 private:
  struct Frames {
    std::optional<std::string> first;
    bool told_empty = false, told_change = false;
  };
  void look(const std::string& frame, const char* sensor, Frames& frames);

  Frames imu_, lidar_;
  bool told_accel_ = false;
  std::vector<std::string> sentences_;
};

}  // namespace allan_lio
