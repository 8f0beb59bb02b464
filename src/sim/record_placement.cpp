// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <stdexcept>

#include "allan_lio/sim/recorded_trajectory.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

Eigen::Quaterniond turn(double yaw) { return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ())); }

struct Box {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
};

/// The record's box after a turn about the vertical.
Box box_of(const Trajectory& record, double yaw) {
  Box box;
  const Eigen::Quaterniond rotation = turn(yaw);
  for (const StampedPose& pose : record) {
    const Vector3d p = rotation * pose.pose.translation;
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

void require_some(const Trajectory& record) {
  if (record.empty()) throw std::invalid_argument("recorded trajectory: it holds no pose");
}

}  // namespace

RigidTransform place_record(const Trajectory& record, const Vector3d& start, double yaw) {
  require_some(record);
  const Eigen::Quaterniond rotation = turn(yaw);
  return {rotation, start - rotation * record.front().pose.translation};
}

RigidTransform align_record(const Trajectory& record, const Vector3d& centre, double heading) {
  require_some(record);
  constexpr double kStep = kPi / 180.0;
  double best = 0.0, narrowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 180; ++i) {
    const Box box = box_of(record, i * kStep);
    const double width = box.high.y() - box.low.y();
    if (width < narrowest) {
      narrowest = width;
      best = i * kStep;
    }
  }
  const Vector3d way = turn(best) * (record.back().pose.translation - record.front().pose.translation);
  if (way.x() < 0) best += kPi;
  const Box box = box_of(record, best);
  const Vector3d middle = turn(heading) * (0.5 * (box.low + box.high));
  return {turn(best + heading), centre - middle};
}

}  // namespace allan_lio
