// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "allan_lio/sim/lidar_simulator.h"
#include "allan_lio/sim/trajectory.h"

namespace allan_lio {

constexpr TimeNs kBoxStart = 1700000000 * kNsPerSecond;
const Eigen::Vector3d kBoxLow(-7.3, -4.1, -1.9), kBoxHigh(9.2, 6.4, 2.7);  // of the box around the LiDAR [m]

inline TriangleMesh box_scene() {
  TriangleMesh mesh;
  mesh.add_box(kBoxLow, kBoxHigh);
  return mesh;
}

/// From the box's inside along `direction` to its walls [m].
inline double range_to_box(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double range = 1e9;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] > 0) range = std::min(range, (kBoxHigh[axis] - origin[axis]) / direction[axis]);
    if (direction[axis] < 0) range = std::min(range, (kBoxLow[axis] - origin[axis]) / direction[axis]);
  }
  return range;
}

inline TrajectoryPlan fast_curve() {
  TrajectoryPlan plan;
  plan.waypoints = {
      {{-3, -1, 0.2}, 1.0}, {{0, 1, 0.2}, 3.0}, {{3, -1, 0.2}, 3.0}, {{4, 2, 0.2}, 3.0}, {{0, 3, 0.2}, 3.0}};
  plan.acceleration = 4.0;
  plan.standstill_begin = 1.0;
  return plan;
}

inline LidarPattern noise_free(const std::string& name) {
  LidarPattern pattern = make_lidar_pattern(name);
  pattern.range_noise = 0.0;
  return pattern;
}

inline bool same_points(const SimSweep& a, const SimSweep& b) {
  if (a.points.size() != b.points.size()) return false;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    const SimPoint &p = a.points[i], &q = b.points[i];
    if (p.x != q.x || p.y != q.y || p.z != q.z || p.intensity != q.intensity || p.ring != q.ring || p.time != q.time)
      return false;
  }
  return true;
}

inline double range_of(const SimPoint& point) { return Eigen::Vector3d(point.x, point.y, point.z).norm(); }

/// A LiDAR driven through the box on the fast curve, which begins with a second of rest.
class BoxDrive : public ::testing::Test {
 protected:
  SimSweep sweep(const LidarPattern& pattern, int index, std::uint64_t seed = 1, int threads = 2) const {
    return LidarSimulator(pattern, default_T_imu_lidar(), trajectory_, caster_, kBoxStart, seed, threads).sweep(index);
  }

  SimTrajectory trajectory_{fast_curve()};
  RayCaster caster_{box_scene()};
};

}  // namespace allan_lio
