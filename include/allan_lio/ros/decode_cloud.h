// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <optional>
#include <string>
#include <vector>

#include "allan_lio/lidar/azimuth_time.h"
#include "allan_lio/lidar/point_time.h"
#include "allan_lio/lidar/scan.h"
#include "allan_lio/lio/lio_config.h"
#include "allan_lio/ros/cloud_layout.h"
#include "allan_lio/ros/cloud_wire.h"
#include "allan_lio/ros/raw_cloud.h"

namespace allan_lio {

/// Either a scan, or a sentence that says why there is none.
struct DecodedCloud {
  std::optional<Scan> scan;
  std::string error;
};

/// sensor_msgs/PointCloud2 of any driver, or Livox's CustomMsg, to Scan, in one pass over the bytes where they lie. x,
/// y, z are float32 or float64; intensity (may be absent) and point time are of any numeric type. Invalid points (NaN,
/// inf, all zero, a time that is no time, noise by Livox's tag) and points out of range are dropped and counted. A few
/// points with an absurd time do not stretch the scan (lidar/sweep_window.h); a scan with many of them is refused.
class CloudDecoder {
 public:
  explicit CloudDecoder(const LioConfig::Lidar& options);

  DecodedCloud decode(const sensor_msgs::PointCloud2& cloud);

  /// The same for the bytes of either type. Bytes that lie about their lengths are an error, and make room for nothing.
  DecodedCloud decode(const RawCloud& cloud);

  /// One line on the point times; empty until a scan has been seen.
  std::string verdict() const;

  /// Sentences on the points that were dropped for their time alone, and for their tag alone.
  std::vector<std::string> remarks() const;

 private:
  DecodedCloud decode(const CloudView& cloud);
  DecodedCloud decode(const CloudLayout& layout, TimeNs stamp);
  /// Reads the points by the rule. A sentence if the scan is to be refused.
  std::string read_by_rule(const CloudLayout& layout, TimeNs stamp, Scan& scan);

  LioConfig::Lidar options_;
  std::optional<LidarTurn> turn_;  ///< if the times are made from the azimuth
  PointTimeDetector detector_;
  double sweep_ns_ = 0.0;  ///< length of the last scan that moved [ns], 0 before the first
  std::uint64_t wild_times_ = 0, tagged_noise_ = 0;
};

}  // namespace allan_lio
