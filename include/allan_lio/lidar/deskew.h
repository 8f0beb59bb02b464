// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "allan_lio/imu/propagate.h"
#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// The propagated motion: from each state the interval that follows it leads to the next.
struct TrackSegment {
  NavState start;
  ImuInterval interval;
};

/// Takes the points of a scan, each from the LiDAR frame at its own time, to the IMU frame at the scan's end.
/// The pose is exact at nodes no farther apart than kNodeSpacing and linear in between: at 10 rad/s and 50 m
/// that is off by less than a millimetre.
class Deskewer {
 public:
  static constexpr double kNodeSpacing = 1e-3;  ///< [s]

  /// `track` covers [scan.begin(), scan.end()] (what lies outside is extrapolated from the nearest segment);
  /// `reference` is the state at the scan's end.
  Deskewer(const Scan& scan, const std::vector<TrackSegment>& track, const NavState& reference,
           const RigidTransform& T_imu_lidar, const ImuNoise& noise);

  /// Without motion compensation: T_imu_lidar for every point.
  explicit Deskewer(const RigidTransform& T_imu_lidar);

  /// The point in the IMU frame at the scan's end [m].
  Eigen::Vector3f operator()(const ScanPoint& point) const;

 private:
  /// Columns of [R | t] as 4-vectors, for a multiply-add each.
  struct Node {
    Eigen::Vector4f column[4];
  };
  static Node make_node(const RigidTransform& T_reference_lidar);

  std::vector<Node> nodes_;
  std::int32_t first_offset_ns_ = 0;
  float nodes_per_ns_ = 0.0F;
};

inline Eigen::Vector3f Deskewer::operator()(const ScanPoint& point) const {
  const std::int64_t since_begin = std::int64_t{point.offset_ns} - first_offset_ns_;
  const float position = static_cast<float>(since_begin) * nodes_per_ns_;
  const int last = static_cast<int>(nodes_.size()) - 2;
  const int index = position <= 0.0F ? 0 : (static_cast<int>(position) < last ? static_cast<int>(position) : last);
  const float s = position - static_cast<float>(index);
  const Node& a = nodes_[static_cast<std::size_t>(index)];
  const Node& b = nodes_[static_cast<std::size_t>(index) + 1];
  Eigen::Vector4f sum = a.column[3] + s * (b.column[3] - a.column[3]);
  sum += point.x * (a.column[0] + s * (b.column[0] - a.column[0]));
  sum += point.y * (a.column[1] + s * (b.column[1] - a.column[1]));
  sum += point.z * (a.column[2] + s * (b.column[2] - a.column[2]));
  return sum.head<3>();
}

}  // namespace allan_lio
