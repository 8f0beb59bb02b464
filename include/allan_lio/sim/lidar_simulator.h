// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/math/time.h"
#include "allan_lio/sim/ray_caster.h"
#include "allan_lio/sim/trajectory.h"

namespace allan_lio {

/// One laser of a spinning LiDAR.
struct LidarBeam {
  double elevation;      ///< above the LiDAR's xy plane [rad]
  double firing_offset;  ///< after its column's time [s]
  std::uint16_t ring;    ///< counted from the lowest beam
};

/// A spinning LiDAR: it begins ahead (+x) and turns clockwise, seen from above.
struct LidarPattern {
  std::string name;
  std::vector<LidarBeam> beams;  ///< in firing order
  int columns = 0;               ///< per revolution
  double rotation_rate = 10.0;   ///< [Hz]
  double min_range = 0.5;        ///< [m]
  double max_range = 100.0;      ///< [m]
  double range_noise = 0.02;     ///< 1 sigma along the beam [m]

  double column_period() const { return 1.0 / (rotation_rate * columns); }  ///< [s]
};

std::vector<std::string> lidar_pattern_names();

/// Throws std::invalid_argument naming the patterns that exist.
LidarPattern make_lidar_pattern(const std::string& name);

/// Where the simulated LiDAR sits unless told otherwise (config/robots/simulated.yaml says the same).
RigidTransform default_T_imu_lidar();

struct SimPoint {
  float x, y, z;    ///< LiDAR frame at the point's own time [m]
  float intensity;  ///< 100 at perpendicular incidence, falling with the cosine
  std::uint16_t ring;
  float time;  ///< since the sweep's start [s]
};

/// One revolution: the beams that met something, in firing order.
struct SimSweep {
  TimeNs begin = 0;
  TimeNs end = 0;
  std::vector<SimPoint> points;
};

/// Scans a mesh along a trajectory, every beam from the pose at its own time. The range noise is a function of
/// seed, sweep, column and beam alone, so the result is the same for any number of threads.
class LidarSimulator {
 public:
  /// `trajectory` and `caster` must outlive this. Throws std::invalid_argument for a pattern without beams, columns,
  /// a positive rotation rate or a usable range, or for beams that fire after their column's time is over.
  LidarSimulator(const LidarPattern& pattern, const RigidTransform& T_imu_lidar, const SimTrajectory& trajectory,
                 const RayCaster& caster, TimeNs start_stamp, std::uint64_t seed, int threads);
  ~LidarSimulator();

  /// Sweeps that are complete after `duration` [s].
  int sweeps_within(double duration) const;

  /// Sweep `index`, from start_stamp + index/rotation_rate on.
  SimSweep sweep(int index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace allan_lio
