// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/sim/lidar_effects.h"

namespace allan_lio {

/// One laser.
struct LidarBeam {
  double elevation;      ///< above the LiDAR's xy plane; of a swinging beam the middle, of a rosette's the shift [rad]
  double firing_offset;  ///< after its column's time [s]
  std::uint16_t ring;    ///< a spinning LiDAR's are counted from the lowest beam
  double phase = 0.0;    ///< of a swinging beam's elevation [rad]
};

/// How the beams move. A sweep of a spinning LiDAR is like the last one; the other motions are functions of the time
/// since the start, whose sweeps are only the pieces in which they are handed out, each with other directions.
enum class ScanMotion {
  kSpinning,  ///< begins each sweep ahead (+x) and turns clockwise, seen from above, once a sweep
  kSwinging,  ///< turns clockwise at motor_rates[0] while the elevation swings by +-swing as a sine of motor_rates[1]
  kRosette,   ///< two prisms, each turning the beam by swing/2, around +x at motor_rates: the petals of a rosette
};

/// A LiDAR of several lasers that fire in columns.
struct LidarPattern {
  std::string name;
  std::vector<LidarBeam> beams;  ///< in firing order
  int columns = 0;               ///< per sweep
  double sweep_rate = 10.0;      ///< [Hz]
  double min_range = 0.5;        ///< [m]
  double max_range = 100.0;      ///< [m]
  double range_noise = 0.02;     ///< 1 sigma along the beam [m]
  ScanMotion motion = ScanMotion::kSpinning;
  double motor_rates[2] = {0.0, 0.0};  ///< of the motions that do not repeat [Hz]; negative: the other way round
  double swing = 0.0;                  ///< largest deflection of those [rad]
  LidarEffects effects;

  double column_period() const { return 1.0 / (sweep_rate * columns); }  ///< [s]
};

std::vector<std::string> lidar_pattern_names();

/// Throws std::invalid_argument naming the patterns that exist.
LidarPattern make_lidar_pattern(const std::string& name);

/// Throws std::invalid_argument for a pattern without beams, columns, a positive sweep rate or a usable range, for
/// beams that fire after their column's time is over, or for effects that cannot be.
void check(const LidarPattern& pattern);

/// Unit vector in the LiDAR frame, `time` [s] after the begin of the sweep that begins at `sweep_begin` [s].
Eigen::Vector3d beam_direction(const LidarPattern& pattern, const LidarBeam& beam, double sweep_begin, double time);

/// Where the simulated LiDAR sits unless told otherwise (config/robots/simulated.yaml says the same).
RigidTransform default_T_imu_lidar();

}  // namespace allan_lio
