// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/localizability.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace allan_lio {

Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned, double scale,
                                    double floor) {
  PoseVector to_metres;  // x_metres = x / to_metres for the rotation's components
  to_metres << PoseVector::Constant(1.0 / scale).head<3>(), 1.0, 1.0, 1.0;
  const PoseMatrix scaled = to_metres.asDiagonal() * information * to_metres.asDiagonal();
  const PoseMatrix scaled_feigned = to_metres.asDiagonal() * feigned * to_metres.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<PoseMatrix> solver(scaled);

  Localizability out;
  out.scale = scale;
  out.directions = solver.eigenvectors();
  for (int k = 0; k < 6; ++k) {
    const PoseVector direction = out.directions.col(k);
    const double found = solver.eigenvalues()[k];
    const double false_part = floor * direction.dot(scaled_feigned * direction);
    out.support[k] = found > 0.0 ? std::max(0.0, 1.0 - false_part / found) : 0.0;
  }
  return out;
}

PoseMatrix support_factor(const Localizability& localizability) {
  PoseVector to_radians;
  to_radians << PoseVector::Constant(localizability.scale).head<3>(), 1.0, 1.0, 1.0;
  const PoseMatrix weighed = localizability.directions * localizability.support.cwiseSqrt().asDiagonal() *
                             localizability.directions.transpose();
  return to_radians.asDiagonal() * weighed * to_radians.cwiseInverse().asDiagonal();
}

}  // namespace allan_lio
