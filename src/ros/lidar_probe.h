// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "allan_lio/calib/sensor_check.h"
#include "allan_lio/ros/bag_reader.h"
#include "allan_lio/ros/decode_cloud.h"

namespace allan_lio {

/// Looks at the clouds of one topic: finds a way to read them, and takes down what they hold.
class LidarProbe {
 public:
  explicit LidarProbe(const BagConnection& connection);

  void add(const BagMessage& message);
  std::size_t messages() const { return messages_; }

  /// The report; call it once, at the end.
  SensorCheck::Lidar finish();

 private:
  /// The first clouds are kept until the way to read them is chosen: as their fields say, with the stamp taken for the
  /// sweep's start, or without times.
  static constexpr std::size_t kTrials = 12;
  void choose_way();
  /// The azimuth's way in whose order most of the clouds' points come, half a turn at least; kAuto: neither.
  PointTime find_turn() const;
  void take(const BagMessage& message);

  SensorCheck::Lidar report_;
  std::vector<BagMessage> kept_;
  std::unique_ptr<CloudDecoder> decoder_;
  std::size_t messages_ = 0;
  std::vector<TimeNs> stamps_, delays_, sweeps_;
  std::vector<std::size_t> points_;
};

}  // namespace allan_lio
