// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "allan_lio/math/time.h"
#include "allan_lio/sim/scene.h"

namespace allan_lio {

/// What to move through, and how.
struct ScenarioOptions {
  std::string scene;                 ///< a name of scene_names(), or "mesh:FILE"
  std::string path;                  ///< waypoints instead of the scene's own, in the drawing; a mesh needs them
  double speed = 1.0;                ///< of waypoints that don't tell theirs [m/s]
  std::string profile = "scene";     ///< or one of motion_profile_names()
  std::string trajectory;            ///< a recorded TUM trajectory instead of a way
  std::optional<double> standstill;  ///< at the beginning [s]; the scene's, or 3 s before a record
  std::vector<double> place;         ///< of the record's first pose in the drawing: x, y, z [m], yaw [rad]; or none
  std::uint64_t seed = 1;
};

struct Scenario {
  Scene scene;
  std::unique_ptr<RayCaster> caster;
  std::unique_ptr<Motion> motion;
  /// Of the motion's time 0, where a record's clock says it: the record's stamps are then those of the motion.
  std::optional<TimeNs> start;
  std::string remark;  ///< how well a record was fitted; a line, or empty
};

/// Throws std::invalid_argument or std::runtime_error with a sentence that names what is wrong: an option, a file and
/// its line, or the place where a way of one's own meets a surface.
Scenario make_scenario(const ScenarioOptions& options);

}  // namespace allan_lio
