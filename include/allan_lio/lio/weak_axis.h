// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// A direction of the pose that the scan leaves to the IMU, as what it mostly is.
struct WeakAxis {
  bool turns = false;                               ///< a rotation about the axis, else a translation along it
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  ///< of unit length, in the world's axes; its sign says nothing
};

/// Column k of the directions; nothing if the LiDAR gets half of its weight along it or more.
std::optional<WeakAxis> weak_axis(const LioResult& result, int k);

/// "translation along (1.00 0.02 0.00); rotation about (0.00 0.00 1.00)" in the world's axes, the weakest first;
/// "none", or that the scan was not registered.
std::string name_weak_axes(const LioResult& result);

}  // namespace allan_lio
