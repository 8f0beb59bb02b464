// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

namespace allan_lio {

/// A point on the floor, the ceiling or a wall of a room about the origin, 10 x 8 x 3 m, `noise` [m] along the
/// surface's normal.
inline std::vector<Eigen::Vector3d> room_points(int count, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal(0.0, noise > 0 ? noise : 1.0);
  const Eigen::Vector3d half(5.03, 4.07, 1.51);
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p(unit(random) * half.x(), unit(random) * half.y(), unit(random) * half.z());
    const int axis = i % 3;
    p[axis] = (i % 2 == 0 ? half[axis] : -half[axis]) + (noise > 0 ? normal(random) : 0.0);
    points.push_back(p);
  }
  return points;
}

/// The same without the two walls across the x axis: a corridor along x, `stretch` times as long as the room.
inline std::vector<Eigen::Vector3d> corridor_points(int count, double noise, unsigned seed, double stretch) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; static_cast<int>(points.size()) < count; ++i) {
    const std::vector<Eigen::Vector3d> more = room_points(count, noise, seed + static_cast<unsigned>(i));
    for (std::size_t k = 0; k < more.size() && static_cast<int>(points.size()) < count; ++k)
      if (k % 3 != 0) points.push_back(Eigen::Vector3d(stretch * more[k].x(), more[k].y(), more[k].z()));
  }
  return points;
}

}  // namespace allan_lio
