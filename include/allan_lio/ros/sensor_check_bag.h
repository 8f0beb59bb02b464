// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "allan_lio/calib/sensor_check.h"

namespace allan_lio {

/// Reads bags, merged by time, for their sensors. `imu_topic` and `lidar_topic` may be empty: then the topic of the
/// right type with most messages is taken. Bags that are cut off or have no index are read as far as they go.
/// `progress` (may be empty) is told the part that is read, 0 to 1, and stops the reading by giving false. Throws
/// BagError for a file that is no bag, a named topic that is not there, and when it is stopped.
SensorCheck check_bags(const std::vector<std::string>& files, const std::string& imu_topic,
                       const std::string& lidar_topic, const std::function<bool(double)>& progress = {});

}  // namespace allan_lio
