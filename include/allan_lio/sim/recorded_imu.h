// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/sim/imu_simulator.h"

namespace allan_lio {

/// A real IMU's log in any layout that ImuCsvReader understands (EuRoC's among them), in SI. Without a unit in its
/// header readings count as rad/s and m/s^2. Rows whose numbers are not finite are left out, as a driver would.
/// Throws std::runtime_error, with the file named, if it holds no times, or times that do not rise, or no sample.
std::vector<ImuSample> read_recorded_imu(const std::string& path);

/// The samples from `begin` to `end`, both included, and the one before, so that an estimator has a reading at the
/// begin. Their biases are not known. Throws std::invalid_argument if the record begins more than 0.1 s after `begin`
/// or ends more than 0.1 s before `end`.
SimulatedImu recorded_imu(const std::vector<ImuSample>& record, TimeNs begin, TimeNs end);

}  // namespace allan_lio
