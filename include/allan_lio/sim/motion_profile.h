// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "allan_lio/sim/trajectory.h"

namespace allan_lio {

/// walking, driving, flying: how a carrier sways, leans and vibrates on its way.
std::vector<std::string> motion_profile_names();

/// Replaces gait, lean and wobbles of `plan`; way and speeds stay. The phases of the wobbles are drawn by `seed`.
/// What is faster than some 30 Hz is for the IMU's error model: here the body, and with it the LiDAR, really moves.
/// Throws std::invalid_argument naming the profiles that exist.
void apply_motion_profile(const std::string& name, std::uint64_t seed, TrajectoryPlan& plan);

}  // namespace allan_lio
