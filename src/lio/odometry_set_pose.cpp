// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// How the odometry takes a pose that is known from elsewhere.
#include "odometry_impl.h"

namespace allan_lio {

void Odometry::Impl::set_pose(const PoseAnchor& anchor) {
  start_.again = true;
  standstill_.end();
  start_.T_world_imu = anchor.T_world_imu;
  start_.position_covariance = anchor.position_covariance;
  start_.heading_variance = anchor.heading_variance;
  if (map_->voxels() == 0) return;  // the first scan founds the map there
  clear_map();
  map_proven_ = false;
  unmatched_in_a_row_ = 0;
  make_first_pose();
  if (deskewer_) insert_scan();
}

}  // namespace allan_lio
