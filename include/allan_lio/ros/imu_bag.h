// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// Which messages of which bags.
struct ImuBagSource {
  std::vector<std::string> bags;  ///< in the order of time
  std::string topic;              ///< sensor_msgs/Imu; empty: the only such topic that there is
  std::string temperature_topic;  ///< sensor_msgs/Temperature; empty: not looked for
};

/// Takes what the bags hold.
struct ImuBagSink {
  std::function<void(const ImuSample&)> sample;  ///< stamped by its header, values as they stand there
  std::function<void(double)> temperature = {};  ///< [degC]
};

struct ImuBagOutcome {
  std::string topic;                  ///< that was read
  std::int64_t undecodable = 0;       ///< messages too short for their type
  std::vector<std::string> troubles;  ///< one sentence for each bag that is not whole
};

/// Streams the readings of an IMU at rest, one bag after the other: memory does not grow with their length. Throws
/// BagError if a file is no bag, or naming the topics that there are if the topic is not there, not unique or not of
/// its type.
ImuBagOutcome read_imu_bags(const ImuBagSource& source, const ImuBagSink& sink);

/// A sensor_msgs/Imu as it is serialised, without making one. False if the bytes end too early.
bool decode_imu(const std::uint8_t* data, std::size_t size, ImuSample* sample);

}  // namespace allan_lio
