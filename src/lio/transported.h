// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// T m for a T of transport(), which is the identity but for three blocks on its diagonal.
template <typename Derived>
void transport_rows(const LioMatrix& T, Eigen::MatrixBase<Derived>& m) {
  m.template middleRows<3>(kTheta) = (T.block<3, 3>(kTheta, kTheta) * m.template middleRows<3>(kTheta)).eval();
  m.template middleRows<2>(kGravity) = (T.block<2, 2>(kGravity, kGravity) * m.template middleRows<2>(kGravity)).eval();
  m.template middleRows<3>(kExtrinsicRotation) =
      (T.block<3, 3>(kExtrinsicRotation, kExtrinsicRotation) * m.template middleRows<3>(kExtrinsicRotation)).eval();
}

/// T P T^T for such a T.
inline LioMatrix transported(const LioMatrix& T, LioMatrix covariance) {
  transport_rows(T, covariance);
  covariance.transposeInPlace();
  transport_rows(T, covariance);
  covariance.transposeInPlace();
  return covariance;
}

}  // namespace allan_lio
