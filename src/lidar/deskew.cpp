// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/deskew.h"

#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

/// The pose at `t`, from the segment that holds it.
RigidTransform pose_at(const std::vector<TrackSegment>& track, TimeNs t, const ImuNoise& noise) {
  auto after = std::upper_bound(track.begin(), track.end(), t,
                                [](TimeNs value, const TrackSegment& s) { return value < s.start.stamp; });
  const TrackSegment& segment = after == track.begin() ? *after : *(after - 1);
  ImuInterval part = segment.interval;
  part.dt = seconds_between(segment.start.stamp, t);
  return propagate_mean(segment.start, part, noise).T_world_imu;
}

}  // namespace

Deskewer::Node Deskewer::make_node(const RigidTransform& T_reference_lidar) {
  const Eigen::Matrix3f rotation = T_reference_lidar.rotation.toRotationMatrix().cast<float>();
  Node node;
  for (int i = 0; i < 3; ++i) node.column[i] << rotation.col(i), 0.0F;
  node.column[3] << T_reference_lidar.translation.cast<float>(), 1.0F;
  return node;
}

Deskewer::Deskewer(const RigidTransform& T_imu_lidar) : nodes_(2, make_node(T_imu_lidar)) {}

Deskewer::Deskewer(const Scan& scan, const std::vector<TrackSegment>& track, const NavState& reference,
                   const RigidTransform& T_imu_lidar, const ImuNoise& noise)
    : first_offset_ns_(scan.first_offset_ns) {
  const double duration = seconds_between(scan.begin(), scan.end());
  const int intervals = std::max(1, static_cast<int>(std::ceil(duration / kNodeSpacing)));
  nodes_per_ns_ = duration > 0 ? static_cast<float>(intervals / (duration * 1e9)) : 0.0F;
  nodes_.reserve(static_cast<std::size_t>(intervals) + 1);
  const RigidTransform T_reference_world = reference.T_world_imu.inverse();
  for (int i = 0; i <= intervals; ++i) {
    const TimeNs t = scan.begin() + to_ns(duration * i / intervals);
    nodes_.push_back(make_node(T_reference_world * pose_at(track, t, noise) * T_imu_lidar));
  }
}

}  // namespace allan_lio
