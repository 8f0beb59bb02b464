// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "allan_lio/sim/mesh.h"

namespace allan_lio {

struct RayHit {
  double range;            ///< [m]
  Eigen::Vector3d normal;  ///< unit, turned towards the ray's origin
};

/// Finds where rays meet a mesh. The triangle is found in single precision, the range on its plane computed in
/// double. Safe to use from several threads.
class RayCaster {
 public:
  /// Throws std::runtime_error if the ray-tracing library gives up.
  explicit RayCaster(const TriangleMesh& mesh);
  ~RayCaster();

  /// The first surface within `max_range` [m] of `origin` along the unit vector `direction`, if there is one.
  std::optional<RayHit> cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, double max_range) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace allan_lio
