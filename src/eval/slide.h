// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "allan_lio/io/tum.h"

namespace allan_lio {

/// A slide by a metre along a way: its direction and by how much it turns, both in the world.
struct Slide {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< [rad/m]
};

/// At every pose along the truth's own way, whose direction is taken over four seconds so that no step's sway is in it;
/// where the truth stands as where it moved last, or will move first. `if_never` is for a truth that never moves.
std::vector<Slide> slides_along(const Trajectory& truth, const Eigen::Vector3d& if_never);

}  // namespace allan_lio
