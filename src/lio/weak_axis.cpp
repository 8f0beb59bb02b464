// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/weak_axis.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

namespace allan_lio {
namespace {

std::string name_of(const WeakAxis& weak) {
  Eigen::Index largest = 0;
  weak.axis.cwiseAbs().maxCoeff(&largest);
  const double sign = weak.axis[largest] < 0.0 ? -1.0 : 1.0;
  const auto rounded = [&](int i) { return std::round(100.0 * sign * weak.axis[i]) / 100.0 + 0.0; };  // never -0.00
  char text[80];
  std::snprintf(text, sizeof text, "%s (%.2f %.2f %.2f)", weak.turns ? "rotation about" : "translation along",
                rounded(0), rounded(1), rounded(2));
  return text;
}

}  // namespace

std::optional<WeakAxis> weak_axis(const LioResult& result, int k) {
  // Rotation about the IMU's axes and translation along the world's, both in metres.
  const PoseVector direction = result.localizability.directions.col(k);
  if (result.localizability.support[k] >= kSupported || direction.norm() == 0.0) return std::nullopt;
  WeakAxis weak;
  weak.turns = direction.head<3>().norm() > direction.tail<3>().norm();
  const Eigen::Vector3d axis =
      weak.turns ? Eigen::Vector3d(result.state.nav.T_world_imu.rotation * direction.head<3>()) : direction.tail<3>();
  weak.axis = axis.normalized();
  return weak;
}

std::string name_weak_axes(const LioResult& result) {
  if (result.outcome != ScanOutcome::kUpdated) return "the scan was not registered";
  std::string names;
  for (int k = 0; k < 6; ++k)
    if (const auto weak = weak_axis(result, k)) names += (names.empty() ? "" : "; ") + name_of(*weak);
  return names.empty() ? "none" : names;
}

}  // namespace allan_lio
