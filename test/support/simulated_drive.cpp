// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_drive.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include "allan_lio/io/config_source.h"
#include "allan_lio/lio/odometry.h"
#include "allan_lio/sim/imu_simulator.h"
#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/scene.h"
#include "simulated_specs.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1'700'000'000 * kNsPerSecond;
constexpr double kImuRate = 200.0;  // [Hz]

Scan to_scan(const SimSweep& sweep) {
  Scan scan;
  scan.stamp = sweep.begin;
  scan.points.reserve(sweep.points.size());
  for (const SimPoint& p : sweep.points)
    scan.points.push_back({p.x, p.y, p.z, p.intensity, static_cast<std::int32_t>(std::lround(1e9 * p.time))});
  const auto earlier = [](const ScanPoint& a, const ScanPoint& b) { return a.offset_ns < b.offset_ns; };
  const auto ends = std::minmax_element(scan.points.begin(), scan.points.end(), earlier);
  if (!scan.points.empty()) {
    scan.first_offset_ns = ends.first->offset_ns;
    scan.last_offset_ns = ends.second->offset_ns;
  }
  return scan;
}

}  // namespace

SimulatedDrive simulate_drive(const std::string& name, double duration, std::uint64_t seed) {
  const Scene scene = make_scene(name);
  LidarPattern pattern = make_lidar_pattern("velodyne16");
  pattern.max_range = scene.max_range;
  const SimTrajectory trajectory(scene.plan);
  const RayCaster caster(scene.mesh);
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const LidarSimulator lidar(pattern, default_T_imu_lidar(), trajectory, caster, kStart, seed, threads);

  SimulatedDrive drive;
  drive.T_world_drawing = scene.T_world_drawing;
  drive.imu = simulate_imu(trajectory, duration, kStart, kImuRate, mti600_spec(), {}, seed).samples;
  for (const ImuSample& sample : drive.imu)
    drive.truth.push_back({sample.stamp, trajectory.at(seconds_between(kStart, sample.stamp)).T_world_imu});
  for (int i = 0; i < lidar.sweeps_within(duration); ++i) drive.scans.push_back(to_scan(lidar.sweep(i)));
  return drive;
}

LioConfig simulated_robot() {
  LioConfig config = default_config(mti600_spec());
  config.T_imu_lidar = default_T_imu_lidar();
  return config;
}

std::vector<LioResult> run_odometry(const SimulatedDrive& drive, const LioConfig& config) {
  Odometry odometry(config);
  std::vector<LioResult> results;
  const auto take = [&] {
    while (std::optional<LioResult> result = odometry.next()) results.push_back(*result);
  };
  std::size_t sample = 0;
  for (const Scan& scan : drive.scans) {
    for (; sample < drive.imu.size() && drive.imu[sample].stamp <= scan.end(); ++sample)
      odometry.add_imu(drive.imu[sample]);
    odometry.add_scan(scan);
    take();
  }
  for (; sample < drive.imu.size(); ++sample) odometry.add_imu(drive.imu[sample]);
  odometry.end_of_data();
  take();
  return results;
}

Trajectory trajectory_of(const std::vector<LioResult>& results) {
  Trajectory trajectory;
  for (const LioResult& result : results) trajectory.push_back({result.state.nav.stamp, result.state.nav.T_world_imu});
  return trajectory;
}

}  // namespace allan_lio
