// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/pose_innovation.h"

#include <Eigen/Eigenvalues>

namespace allan_lio {

PoseInnovation pose_innovation(const PoseMatrix& information, const PoseVector& gradient, const PoseMatrix& prior,
                               const Localizability& localizability) {
  constexpr double kSupported = 0.5;
  PoseVector to_metres;
  to_metres << PoseVector::Constant(localizability.scale).head<3>(), 1.0, 1.0, 1.0;
  // In metres: P grows with the scale, information and gradient fall with it.
  const PoseMatrix scaled_prior = to_metres.asDiagonal() * prior * to_metres.asDiagonal();
  const PoseMatrix scaled_information =
      to_metres.cwiseInverse().asDiagonal() * information * to_metres.cwiseInverse().asDiagonal();
  const PoseVector scaled_gradient = gradient.cwiseQuotient(to_metres);

  PoseInnovation out;
  PoseMatrix supported;  // its first dof columns
  for (int k = 0; k < 6; ++k)
    if (localizability.support[k] >= kSupported) supported.col(out.dof++) = localizability.directions.col(k);
  if (out.dof == 0) return out;
  // The directions are the information's own, so it is diagonal in them and each is measured by itself.
  const Eigen::MatrixXd d = supported.leftCols(out.dof);
  const Eigen::VectorXd measured = (d.transpose() * scaled_information * d).diagonal();
  const Eigen::VectorXd innovation = (d.transpose() * scaled_gradient).cwiseQuotient(measured);
  Eigen::MatrixXd covariance = d.transpose() * scaled_prior * d;
  covariance.diagonal() += measured.cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  out.whitened = d * (solver.operatorInverseSqrt() * innovation);
  out.nis = out.whitened.squaredNorm();
  return out;
}

}  // namespace allan_lio
