// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace allan_lio {

using PoseMatrix = Eigen::Matrix<double, 6, 6>;
using PoseVector = Eigen::Matrix<double, 6, 1>;

constexpr double kSupported = 0.5;  ///< support from which a direction counts as measured

/// How far a scan supports the six directions of the pose.
///
/// The directions are those in which both the information and the part of it that the normals' noise feigns are
/// diagonal: a direction with ratio 1 is told by noise alone, whatever its unit. They need not be orthogonal.
struct Localizability {
  /// Probability that the scan tells more along the direction than the floor times what noise feigns.
  PoseVector probability = PoseVector::Ones();
  /// Weight in [0, 1] that the LiDAR gets along each column of `directions`: 0 is left to the IMU.
  PoseVector support = PoseVector::Ones();
  /// Columns of unit length in (rotation, translation), weakest first, the rotation's components scaled by the scene's
  /// size so that both read as metres.
  PoseMatrix directions = PoseMatrix::Identity();
  /// Columns that are exact translations or rotations: what seemed to couple them to others was noise (decouple.h).
  std::array<bool, 6> pure = {};
  double scale = 1.0;  ///< the scene's size: root mean square range [m]
};

/// The columns of `directions` in radians and metres.
PoseMatrix unscaled_directions(const Localizability& localizability);

/// The directions to be judged, in (rotation, translation) scaled as in Localizability: generalised eigenvectors of
/// `information` and `feigned`, which are about the pose in radians and metres.
PoseMatrix support_directions(const PoseMatrix& information, const PoseMatrix& feigned, double scale);

/// Judges each direction by the ratio of information to what the normals' noise feigns along it (doc/decisions.md 2;
/// the idea of a probability is Hatleskog and Alexis', RA-L 2024). `squares` is, by direction, the sum of the squares
/// of what single things, planes or columns of them, contribute to the information (PointToPlane::squares_along):
/// information^2 / squares is the number of things that hold the direction up, and says how far the ratio can be
/// trusted; 0 stands for very many. The weight is
///   probability of ratio > floor, times 1 - 1 / ratio, times (things / 8)^2 where fewer than 8 hold it up.
Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned,
                                    const PoseMatrix& directions, const PoseVector& squares, double scale,
                                    double floor);

/// The same for very many of them.
Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned, double scale,
                                    double floor);

/// The 6 x 6 factor T that weighs the gradient by the support: it becomes T gradient.
PoseMatrix support_factor(const Localizability& localizability);

/// The information weighed by the support: diagonal in the directions. It is T information where the directions are
/// those of support_directions(); of a pure direction the coupling to others is gone.
PoseMatrix weighed_information(const PoseMatrix& information, const Localizability& localizability);

/// Takes the part along the pure directions out of a pose's error.
PoseMatrix without_pure(const Localizability& localizability);

}  // namespace allan_lio
