// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/sim/mesh.h"

namespace allan_lio {

// What several scenes are built of, in the drawing's frame [m].

constexpr double kSceneImuHeight = 1.2;  ///< of a person or a small car above the ground [m]

/// A shell of the corridor's height along x, open at both ends.
void add_tube(TriangleMesh& mesh, double begin, double end, double half_width);

/// A wall of the corridor's height across x from y = `from` to `to`.
void add_cross_wall(TriangleMesh& mesh, double x, double from, double to);

/// The furnished hall beyond the mouth at x = `mouth` of a corridor along x; `out` is the direction away from the
/// corridor, +1 or -1.
void add_hall(TriangleMesh& mesh, double mouth, double out);

/// Flat ground at z = 0.
void add_ground(TriangleMesh& mesh, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

/// A body and a cabin on the ground, 4.4 m long.
void add_car(TriangleMesh& mesh, const Eigen::Vector2d& centre, double yaw);

/// A box of `size` that stands at `centre` on the ground.
void add_block(TriangleMesh& mesh, const Eigen::Vector2d& centre, const Eigen::Vector3d& size, double yaw);

}  // namespace allan_lio
