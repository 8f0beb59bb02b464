// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>

#include "allan_lio/imu/imu_buffer.h"
#include "allan_lio/imu/imu_gate.h"
#include "allan_lio/lidar/scan.h"
#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// Brings the two streams together: hands out a scan once the IMU's data reaches its end. What it hands out depends
/// on the streams alone, not on how they interleave.
class Synchronizer {
 public:
  explicit Synchronizer(LioCounters& counters) : counters_(counters) {}

  void add_imu(const ImuSample& sample);
  void add_scan(Scan scan);
  void end_of_data();

  /// Factor from the accelerometer's readings to m/s^2, by which they are judged from now on; 1 before. Those at hand
  /// that are absurd by it are dropped and counted; gives how many of them had been let into imu().
  std::size_t set_accel_scale(double scale);

  const ImuBuffer& imu() const { return imu_; }
  bool ended() const { return ended_; }

  /// The oldest waiting scan that begins inside the IMU's data, or null.
  const Scan* front();

  /// The oldest waiting scan, if the IMU's data covers it. When the data has ended, a scan that ends at most
  /// kBridge after the last sample passes too.
  std::optional<Scan> take();

  /// The IMU's data begins anew with the sample at `t`: forgets what was before, and takes back a scan that take()
  /// gave.
  void begin_again(TimeNs t, Scan scan);

  /// Forgets the IMU data that nothing after `t` needs.
  void discard_before(TimeNs t) { imu_.discard_before(t); }

  static constexpr double kBridge = 0.1;  ///< [s]

 private:
  static constexpr std::size_t kMostWaiting = 100;  ///< scans; then the IMU is taken for silent
  static constexpr double kSuspiciousLeap = 1.0;    ///< [s] of a scan, ahead of the one before
  static constexpr double kKeptWithoutScans = 600;  ///< [s] of IMU data

  void take_imu(const ImuSample& sample);
  void take_scan(Scan scan);

  LioCounters& counters_;
  ImuGate gate_;
  ImuBuffer imu_;
  std::deque<Scan> scans_;
  std::optional<TimeNs> first_imu_;
  std::optional<TimeNs> newest_scan_end_;
  /// A scan far ahead of its time: kept back until the next one tells a gap from a wrong stamp.
  std::optional<Scan> suspect_scan_;
  bool ended_ = false;
};

}  // namespace allan_lio
