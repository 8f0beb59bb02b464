// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/lidar_pattern.h"

namespace allan_lio {

/// What the sensors of a simulation were, for the files beside its bag: YAML, SI units and radians. `recorded_imu` is
/// the log that stood in for the simulated IMU, or empty; then the errors in force and the constants that were drawn
/// for this seed are listed.
std::string sensor_report(const LidarPattern& pattern, const std::string& recorded_imu, const ImuErrorConfig& errors,
                          double imu_rate, std::uint64_t seed);

}  // namespace allan_lio
