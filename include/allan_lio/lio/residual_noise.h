// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "allan_lio/lio/localizability.h"
#include "allan_lio/map/plane.h"

namespace allan_lio {

/// What all scans' residuals share.
struct ResidualOptions {
  double range_variance;     ///< of one range measurement [m^2]
  double gate;               ///< [sigma]
  double robust_scale;       ///< [sigma]
  bool estimate_extrinsics;  ///< else the last six rows and columns stay zero
  double k_r = 1.0;          ///< multiplies what a point adds of its own
  double divergence = 0.0;   ///< full angle of a beam [rad]
};

/// What the prediction leaves uncertain about a scan.
struct ScanUncertainty {
  PoseMatrix pose = PoseMatrix::Zero();  ///< covariance of the predicted pose against the map (rotation, translation)
  /// The same against each part of the map, for the gate: what was seen long ago may lie aside by all that the run has
  /// drifted since, and who takes it for something else will never find back.
  std::vector<PoseMatrix> parts;
  /// The same of the pose that the residuals are taken at: along what an iteration has measured it is small.
  PoseMatrix iterate = PoseMatrix::Zero();
  /// Covariance by which deskewing with a wrong velocity smears the points, over the scan [m^2], world.
  Eigen::Matrix3d smear = Eigen::Matrix3d::Zero();
  double turn = 0.0;  ///< variance by which deskewing with a wrong rate turns them, per axis [rad^2]
};

/// Variance of a point-to-plane residual [m^2], in the parts that behave differently.
struct ResidualVariance {
  double own = 0.0;     ///< of the point: range, beam, deskewing
  double plane = 0.0;   ///< of the plane's height under the point
  double center = 0.0;  ///< of the plane's centre, the same for all points on it
  double lean = 0.0;    ///< of the prediction through the normal's error, the same for all points on it
};

/// The noise of one scan's residuals z = n^T (R q + p - c).
///
/// The prediction of z errs by dh^T x as well, where x is the pose's error and dh what the normal's error puts into the
/// residual's Jacobian (errors in variables). In a room x is nothing. In a field or a tunnel x is metres along what no
/// plane measures, and taken for exact the noise of the normals measures it: tilt and height, known well, are found
/// "shifted" by their product. Each new set of planes is another look that would believe so, up to half of the
/// variance; kLooks of them pass in some minutes (decisions 13). x is the pose's error against the part of the map that
/// the plane belongs to: what was made a second ago has drifted along.
class ResidualNoise {
 public:
  ResidualNoise(const ResidualOptions& options, const ScanUncertainty& scan)
      : k_r_squared_(options.k_r * options.k_r),
        range_variance_(options.range_variance),
        beam_(kBeamSigma * kBeamSigma * options.divergence * options.divergence),
        scan_(scan),
        rotation_(scan.iterate.diagonal().head<3>().sum()),
        translation_(scan.iterate.diagonal().tail<3>().sum()),
        smear_(scan.smear.trace()) {}

  /// `against_part`: covariance of the predicted pose against the plane's part of the map, or null.
  /// `q` and `normal` in the IMU's frame [m], from whose origin the beam is taken to come (the LiDAR is some decimetres
  /// away, which matters to none but the nearest points); `point` in the world [m]; `lean_1`, `lean_2`: the residual's
  /// Jacobian with the plane's leans for its normal.
  ResidualVariance of(const Plane& plane, const Eigen::Vector3d& q, const Eigen::Vector3d& normal,
                      const Eigen::Vector3d& point, const PoseVector& lean_1, const PoseVector& lean_2,
                      const PoseMatrix* against_part = nullptr) const {
    ResidualVariance out;
    const double squared_range = q.squaredNorm(), height = normal.dot(q);
    // Of the range's noise the cosine of the angle of incidence lies along the normal. At grazing incidence the spot is
    // long: a fraction of r * divergence * tan along the beam, times that cosine.
    const double squared_cosine = std::max(kLeastSquaredCosine, height * height / squared_range);
    out.own = k_r_squared_ *
              (std::max(range_variance_ * squared_cosine, plane.thickness) + beam_ * (squared_range - height * height));
    const double smear = smear_ + scan_.turn * squared_range;
    if (smear > kNegligible * range_variance_)
      out.own += plane.normal.dot(scan_.smear * plane.normal) + scan_.turn * squared_range;
    out.plane = plane.variance_at(point);
    out.center = plane.center_variance;
    const double leans = plane.lean_1.squaredNorm() + plane.lean_2.squaredNorm();
    if (kLooks * leans * (translation_ + rotation_ * squared_range) > kNegligible * range_variance_) {
      out.lean = lean_variance(scan_.iterate, lean_1, lean_2);
      if (against_part) out.lean = std::min(out.lean, lean_variance(*against_part, lean_1, lean_2));
    }
    return out;
  }

  static constexpr double kLooks = 512.0;

 private:
  static double lean_variance(const PoseMatrix& pose, const PoseVector& lean_1, const PoseVector& lean_2) {
    return kLooks * (lean_1.dot(pose * lean_1) + lean_2.dot(pose * lean_2));
  }

  static constexpr double kBeamSigma = 0.25;   ///< of the full angle: the spot is four sigma wide
  static constexpr double kNegligible = 0.01;  ///< of the range's variance

  double k_r_squared_, range_variance_, beam_;
  const ScanUncertainty& scan_;
  double rotation_, translation_, smear_;  ///< traces
};

}  // namespace allan_lio
