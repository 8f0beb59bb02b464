// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

constexpr double kPoseLever = 10.0;  ///< [m], at which rotations are compared with translations

/// Both parts of a pose's error (rotation [rad], translation [m]) in metres.
inline PoseVector in_metres(PoseVector pose) {
  pose.head<3>() *= kPoseLever;
  return pose;
}

/// A pose's error (rotation in the IMU's frame [rad], translation in the world [m]) as one of the state.
inline LioVector state_error(const PoseVector& pose) {
  LioVector out = LioVector::Zero();
  out.segment<3>(kTheta) = pose.head<3>();
  out.segment<3>(kPosition) = pose.tail<3>();
  return out;
}

}  // namespace allan_lio
