// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/pose_innovation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace allan_lio {

PoseInnovation pose_innovation(const PoseMatrix& information, const PoseVector& gradient, const PoseMatrix& prior,
                               const Localizability& localizability) {
  PoseVector to_metres;
  to_metres << PoseVector::Constant(localizability.scale).head<3>(), 1.0, 1.0, 1.0;
  // The pose's error in metres is X y. In y the information is diagonal, so that each direction is measured by itself.
  const PoseMatrix& x = localizability.directions;
  const PoseMatrix to_y = x.inverse() * to_metres.asDiagonal();
  const PoseMatrix prior_y = to_y * prior * to_y.transpose();
  const PoseMatrix from_y = to_metres.cwiseInverse().asDiagonal() * x;
  const PoseVector measured = (from_y.transpose() * information * from_y).diagonal();
  const PoseVector innovation = (from_y.transpose() * gradient).cwiseQuotient(measured);

  PoseInnovation out;
  int supported[6];
  for (int k = 0; k < 6; ++k)
    if (localizability.support[k] >= kSupported) supported[out.dof++] = k;
  if (out.dof == 0) return out;
  Eigen::MatrixXd covariance(out.dof, out.dof), axes(6, out.dof);
  Eigen::VectorXd y(out.dof);
  for (int i = 0; i < out.dof; ++i) {
    y[i] = innovation[supported[i]];
    axes.col(i) = x.col(supported[i]);
    for (int j = 0; j < out.dof; ++j) covariance(i, j) = prior_y(supported[i], supported[j]);
    covariance(i, i) += 1.0 / measured[supported[i]];
  }
  // In metres again, in the nearest orthonormal axes of the supported space, where the symmetric root whitens.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(axes.transpose() * axes);
  const Eigen::MatrixXd root = gram.operatorSqrt(), orthonormal = axes * gram.operatorInverseSqrt();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(root * covariance * root.transpose());
  out.whitened = orthonormal * (solver.operatorInverseSqrt() * (root * y));
  out.nis = out.whitened.squaredNorm();
  out.log_det = solver.eigenvalues().array().log().sum();
  return out;
}

}  // namespace allan_lio
