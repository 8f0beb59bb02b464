// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/scan_error.h"

namespace allan_lio {

ScanError deskewing_error(double duration, const Eigen::Vector3d& gyro_psd) {
  ScanError out;
  out.noise.diagonal().head<3>() = duration / 3.0 * gyro_psd;
  out.with_state.block<3, 3>(kTheta, 0).diagonal() = 0.5 * duration * gyro_psd;
  return out;
}

}  // namespace allan_lio
