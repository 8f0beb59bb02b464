// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>

#include "allan_lio/sim/lidar_simulator.h"

namespace allan_lio {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180.0;

/// Elevations evenly from `low` to `high` [deg].
double even_elevation(int ring, int rings, double low, double high) {
  return kDegree * (low + (high - low) * ring / (rings - 1));
}

/// Lower and upper half fire by turns, as in Velodyne's heads: rings 0, n/2, 1, n/2 + 1, ...
LidarPattern interleaved(const std::string& name, int rings, double low, double high, int columns, double firing_time) {
  LidarPattern pattern;
  pattern.name = name;
  pattern.columns = columns;
  for (int i = 0; i < rings; ++i) {
    const int ring = i / 2 + (i % 2) * rings / 2;
    pattern.beams.push_back(
        {even_elevation(ring, rings, low, high), i * firing_time, static_cast<std::uint16_t>(ring)});
  }
  return pattern;
}

/// All rings of a column fire at once, as in Ouster's heads.
LidarPattern simultaneous(const std::string& name, int rings, double low, double high, int columns) {
  return interleaved(name, rings, low, high, columns, 0.0);
}

}  // namespace

std::vector<std::string> lidar_pattern_names() { return {"velodyne16", "velodyne32", "ouster64"}; }

LidarPattern make_lidar_pattern(const std::string& name) {
  // Firing times and fields of view from the VLP-16, HDL-32E and OS1-64 user manuals.
  if (name == "velodyne16") return interleaved(name, 16, -15.0, 15.0, 1800, 2.304e-6);
  if (name == "velodyne32") return interleaved(name, 32, -30.67, 10.67, 2160, 1.152e-6);
  if (name == "ouster64") return simultaneous(name, 64, -16.6, 16.6, 1024);
  std::string known;
  for (const std::string& one : lidar_pattern_names()) known += (known.empty() ? "" : ", ") + one;
  throw std::invalid_argument("there is no LiDAR '" + name + "' to simulate; there are " + known);
}

RigidTransform default_T_imu_lidar() {
  RigidTransform mount;
  mount.rotation = Eigen::AngleAxisd(0.5 * kDegree, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(-0.3 * kDegree, Eigen::Vector3d::UnitY());
  mount.translation = Eigen::Vector3d(0.05, 0.02, 0.10);
  return mount;
}

}  // namespace allan_lio
