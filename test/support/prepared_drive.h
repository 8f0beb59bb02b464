// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/calib/prepared_record.h"
#include "allan_lio/lidar/thin_scan.h"
#include "simulated_drive.h"

namespace allan_lio {

/// The drive as tune_noise would have it from a bag, thinned by the configuration's leaves.
inline PreparedRecord prepared(const SimulatedDrive& drive, const LioConfig& config, bool with_truth = true) {
  PreparedRecord record;
  ScanDownsampler downsampler;
  std::size_t sample = 0;
  for (const Scan& scan : drive.scans) {
    for (; sample < drive.imu.size() && drive.imu[sample].stamp <= scan.end(); ++sample) record.add(drive.imu[sample]);
    record.add(thin_scan(scan, config.map.insert_leaf, config.lidar.leaf, downsampler));
  }
  for (; sample < drive.imu.size(); ++sample) record.add(drive.imu[sample]);
  if (with_truth) record.set_reference(drive.truth);
  return record;
}

}  // namespace allan_lio
