// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace allan_lio {

using PoseMatrix = Eigen::Matrix<double, 6, 6>;
using PoseVector = Eigen::Matrix<double, 6, 1>;

/// How far a scan supports the six directions of the pose.
struct Localizability {
  /// Weight in [0, 1] that the LiDAR gets along each column of `directions`: 0 is left to the IMU.
  PoseVector support = PoseVector::Ones();
  /// Columns: eigen-directions of the information in (rotation, translation), weakest first, the rotation's
  /// components scaled by the scene's size so that both read as metres.
  PoseMatrix directions = PoseMatrix::Identity();
  double scale = 1.0;  ///< the scene's size: root mean square range [m]
};

/// Judges each eigen-direction of the information against what the normals' noise feigns along it:
/// support = max(0, 1 - floor * feigned / information). A direction whose information is mere noise of the map has
/// information = feigned and gets none; one that surfaces truly support has thousands of times as much.
Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned, double scale,
                                    double floor);

/// The 6 x 6 factor W that weighs the information by the support: information becomes W information W^T
/// and gradient becomes W W gradient.
PoseMatrix support_factor(const Localizability& localizability);

}  // namespace allan_lio
