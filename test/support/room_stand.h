// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "allan_lio/lio/odometry.h"
#include "scene_points.h"

namespace allan_lio {

constexpr TimeNs kImuStep = 5'000'000, kScanStep = 100'000'000;
constexpr TimeNs kStart = 1'700'000'000'000'000'000;

/// A scan of points that stand still, as an instantaneous one.
inline Scan scan_of(TimeNs stamp, const std::vector<Eigen::Vector3d>& points, int duration_ns = 90'000'000) {
  Scan scan;
  scan.stamp = stamp;
  scan.last_offset_ns = duration_ns;
  for (const Eigen::Vector3d& p : points)
    scan.points.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0, 0});
  return scan;
}

/// The points of a scan; nothing if it is lost.
using SceneAt = std::function<std::optional<std::vector<Eigen::Vector3d>>(int)>;

struct Drive {
  std::vector<LioResult> results;
  LioCounters counters;
};

/// Ten scans a second of `scene`, IMU at 200 Hz standing level except where `imu_filter` drops or changes a sample.
inline Drive stand(
    const LioConfig& config, int scans, const SceneAt& scene,
    const std::function<bool(ImuSample&)>& imu_filter = [](ImuSample&) { return true; }) {
  Odometry odometry(config);
  Drive run;
  const auto drain = [&] {
    while (auto result = odometry.next()) run.results.push_back(*result);
  };
  TimeNs imu_time = kStart - 20'000'000;
  for (int i = 0; i < scans; ++i) {
    const TimeNs stamp = kStart + i * kScanStep;
    for (; imu_time <= stamp + kScanStep; imu_time += kImuStep) {
      ImuSample sample{imu_time, {0, 0, 0}, {0, 0, 9.80665}};
      if (imu_filter(sample)) odometry.add_imu(sample);
    }
    if (const auto points = scene(i)) odometry.add_scan(scan_of(stamp, *points));
    drain();
  }
  odometry.end_of_data();
  drain();
  run.counters = odometry.counters();
  return run;
}

inline std::vector<Eigen::Vector3d> room(int i) { return room_points(20000, 0.02, static_cast<unsigned>(i)); }

inline bool is_finite(const LioResult& r) {
  return r.covariance.allFinite() && r.state.nav.T_world_imu.translation.allFinite() &&
         r.state.nav.velocity_world.allFinite();
}

inline double strayed(const LioResult& r) { return r.state.nav.T_world_imu.translation.norm(); }

}  // namespace allan_lio
