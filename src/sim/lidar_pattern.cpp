// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/lidar_pattern.h"

#include <cmath>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;
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

/// Livox Avia: six lines behind two prisms; they stand above each other, so that the field is 70.4 deg wide and
/// 77.2 deg high, with 240000 points a second (data sheet). The prisms' rates are those told of the Mid-40, 7294 and
/// -4664 rpm (quoted from memory of Liu, Wang and Zhang 2020): the rosette closes after 30 s.
LidarPattern livox_avia(const std::string& name) {
  constexpr int kLines = 6;
  LidarPattern pattern;
  pattern.name = name;
  pattern.columns = 4000;
  pattern.motion = ScanMotion::kRosette;
  pattern.motor_rates[0] = 7294.0 / 60.0;
  pattern.motor_rates[1] = -4664.0 / 60.0;
  pattern.swing = 35.2 * kDegree;
  for (int i = 0; i < kLines; ++i)
    pattern.beams.push_back({even_elevation(i, kLines, -3.4, 3.4), 0.0, static_cast<std::uint16_t>(i)});
  return pattern;
}

/// Livox Mid-360: all around, -7 to 52 deg, four lines, 200000 points a second (data sheet). The way in which its
/// lines fill this field is not published; swinging beams that never repeat stand for it, with rates of our choice.
LidarPattern livox_mid360(const std::string& name) {
  constexpr int kLines = 4;
  LidarPattern pattern;
  pattern.name = name;
  pattern.columns = 5000;
  pattern.motion = ScanMotion::kSwinging;
  pattern.motor_rates[0] = 10.37;
  pattern.motor_rates[1] = 203.3;
  pattern.swing = 29.5 * kDegree;
  for (int i = 0; i < kLines; ++i)
    pattern.beams.push_back({22.5 * kDegree, 0.0, static_cast<std::uint16_t>(i), kTwoPi * i / kLines});
  return pattern;
}

Eigen::Vector3d direction_of(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)};
}

}  // namespace

std::vector<std::string> lidar_pattern_names() {
  return {"velodyne16", "velodyne32", "ouster64", "livox_avia", "livox_mid360"};
}

LidarPattern make_lidar_pattern(const std::string& name) {
  // Firing times and fields of view from the VLP-16, HDL-32E and OS1-64 user manuals.
  if (name == "velodyne16") return interleaved(name, 16, -15.0, 15.0, 1800, 2.304e-6);
  if (name == "velodyne32") return interleaved(name, 32, -30.67, 10.67, 2160, 1.152e-6);
  if (name == "ouster64") return simultaneous(name, 64, -16.6, 16.6, 1024);  // its mode 1024x10
  if (name == "livox_avia") return livox_avia(name);
  if (name == "livox_mid360") return livox_mid360(name);
  std::string known;
  for (const std::string& one : lidar_pattern_names()) known += (known.empty() ? "" : ", ") + one;
  throw std::invalid_argument("there is no LiDAR '" + name + "' to simulate; there are " + known);
}

void check(const LidarPattern& pattern) {
  const auto require = [&](bool good, const char* sentence) {
    if (!good) throw std::invalid_argument("LiDAR '" + pattern.name + "': " + sentence);
  };
  require(!pattern.beams.empty(), "it has no beams");
  require(pattern.columns > 0, "the number of columns must be positive");
  require(pattern.sweep_rate > 0, "the sweep rate must be positive");
  require(pattern.min_range >= 0 && pattern.max_range > pattern.min_range,
          "the maximum range must exceed the minimum range, and that must not be negative");
  require(pattern.range_noise >= 0, "the range noise must not be negative");
  for (const LidarBeam& beam : pattern.beams)
    require(beam.firing_offset >= 0 && beam.firing_offset < pattern.column_period(),
            "a beam fires outside its column's time");
  check(pattern.effects);
}

Eigen::Vector3d beam_direction(const LidarPattern& pattern, const LidarBeam& beam, double sweep_begin, double time) {
  if (pattern.motion == ScanMotion::kSpinning) return direction_of(-kTwoPi * pattern.sweep_rate * time, beam.elevation);
  const double first = kTwoPi * pattern.motor_rates[0] * (sweep_begin + time);
  const double second = kTwoPi * pattern.motor_rates[1] * (sweep_begin + time);
  if (pattern.motion == ScanMotion::kSwinging)
    return direction_of(-first, beam.elevation + pattern.swing * std::sin(second + beam.phase));
  return direction_of(0.5 * pattern.swing * (std::cos(first) + std::cos(second)),
                      0.5 * pattern.swing * (std::sin(first) + std::sin(second)) + beam.elevation);
}

RigidTransform default_T_imu_lidar() {
  RigidTransform mount;
  mount.rotation = Eigen::AngleAxisd(0.5 * kDegree, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(-0.3 * kDegree, Eigen::Vector3d::UnitY());
  mount.translation = Eigen::Vector3d(0.05, 0.02, 0.10);
  return mount;
}

}  // namespace allan_lio
