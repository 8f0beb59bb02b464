// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/lidar/scan.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// What simulate_bag would write, without a bag.
struct SimulatedDrive {
  std::vector<ImuSample> imu;  ///< MTi-600 at 200 Hz
  std::vector<Scan> scans;     ///< 16 beams at 10 Hz
  Trajectory truth;            ///< at the IMU's stamps
  RigidTransform T_world_drawing;
};

SimulatedDrive simulate_drive(const std::string& scene, double duration, std::uint64_t seed);

/// The configuration that fits the simulated robot.
LioConfig simulated_robot();

/// Feeds the whole drive to an Odometry.
std::vector<LioResult> run_odometry(const SimulatedDrive& drive, const LioConfig& config);

Trajectory trajectory_of(const std::vector<LioResult>& results);

}  // namespace allan_lio
