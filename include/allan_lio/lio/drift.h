// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/lio/lio_result.h"
#include "allan_lio/map/voxel_map.h"

namespace allan_lio {

// 1 sigma of the position against a part of the map [m]:
constexpr double kDriftedOff = 0.1;   ///< from which a point looks for that part's planes beside it
constexpr double kMayBeAside = 0.05;  ///< from which on the run is looked for (PlaceSearch), as it may be too sure

/// What to look for beside the points, by the covariances of the pose (rotation [rad], translation [m]) against the
/// parts of the map, which end at these epochs (ascending; as many): the parts that the run has drifted off by more
/// than `drifted_off` (1 sigma [m]) lie aside by up to three sigma. Without that a run comes back beside its own walls,
/// makes new ones there and stays.
OldPlanes old_planes(const std::vector<PoseMatrix>& against_parts, const std::vector<std::uint32_t>& last_epochs,
                     double drifted_off);

/// The part whose position the run has drifted off the farthest; null if there is no part.
const PoseMatrix* farthest_part(const std::vector<PoseMatrix>& against_parts);

}  // namespace allan_lio
