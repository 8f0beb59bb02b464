// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/math/time.h"
#include "allan_lio/sim/lidar_pattern.h"
#include "allan_lio/sim/motion.h"
#include "allan_lio/sim/ray_caster.h"

namespace allan_lio {

struct SimPoint {
  float x, y, z;    ///< LiDAR frame at the point's own time [m]
  float intensity;  ///< 100 at perpendicular incidence, falling with the cosine (lidar_effects.h: and the range)
  std::uint16_t ring;
  float time;  ///< since the sweep's start [s]
};

/// One sweep: the beams that met something, in firing order.
struct SimSweep {
  TimeNs begin = 0;
  TimeNs end = 0;
  std::vector<SimPoint> points;
};

/// Scans a mesh along a trajectory, every beam from the pose at its own time. Range noise and effects are functions
/// of seed, sweep, column and beam alone, so the result is the same for any number of threads.
class LidarSimulator {
 public:
  /// `trajectory` and `caster` must outlive this. Throws std::invalid_argument for a pattern that check() refuses.
  LidarSimulator(const LidarPattern& pattern, const RigidTransform& T_imu_lidar, const Motion& trajectory,
                 const RayCaster& caster, TimeNs start_stamp, std::uint64_t seed, int threads);
  ~LidarSimulator();

  /// Sweeps that are complete after `duration` [s].
  int sweeps_within(double duration) const;

  /// Sweep `index`, from start_stamp + index/sweep_rate on.
  SimSweep sweep(int index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace allan_lio
