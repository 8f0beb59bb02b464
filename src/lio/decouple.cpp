// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/decouple.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace allan_lio {
namespace {

constexpr double kCoupled = 4.0;  ///< chi^2 per degree of freedom from which a coupling is believed

using Columns = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, 6>;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

/// How many of the directions have no support, if these come first; 0 if they do not, or if all are without.
int count_weak(const Localizability& l) {
  int weak = 0;
  while (weak < 6 && l.support[weak] < kSupported) ++weak;
  for (int k = weak; k < 6; ++k)
    if (l.support[k] < kSupported) return 0;
  return weak == 6 ? 0 : weak;
}

/// The pure translations and rotations nearest to the space of the columns, as many as these; none if there are fewer.
Columns pure_directions(const Columns& weak) {
  const int count = static_cast<int>(weak.cols());
  const Columns basis = Eigen::HouseholderQR<Columns>(weak).householderQ() * Columns::Identity(6, count);
  const PoseMatrix projector = basis * basis.transpose();
  Columns out = Columns::Zero(6, count);
  int found = 0;
  for (const int row : {3, 0}) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(projector.block<3, 3>(row, row));
    for (int k = 2; k >= 0 && found < count; --k)
      if (solver.eigenvalues()[k] > 0.5) out.col(found++).segment<3>(row) = solver.eigenvectors().col(k);
  }
  return found == count ? out : Columns(6, 0);
}

}  // namespace

void decouple(const PoseMatrix& information, const PoseMatrix& feigned, const CouplingNoise& noise,
              Localizability& localizability) {
  const int weak = count_weak(localizability);
  if (weak == 0) return;
  const Columns found = localizability.directions.leftCols(weak), pure = pure_directions(found);
  if (pure.cols() == 0) return;
  const Eigen::FullPivLU<Small> mix(Small(pure.transpose() * found));
  if (!mix.isInvertible()) return;

  const Columns supported = unscaled_directions(localizability).rightCols(6 - weak);
  localizability.directions.leftCols(weak) = found * mix.inverse();  // each a pure one and its couplings
  for (int k = 0; k < weak; ++k) {
    PoseVector direction = pure.col(k);
    direction.head<3>() /= localizability.scale;
    const Small coupling = supported.transpose() * (information - feigned) * direction;
    const Small covariance = supported.transpose() * noise(direction) * supported;
    const double chi_squared = coupling.col(0).dot(covariance.ldlt().solve(coupling).col(0));
    if (!(chi_squared < kCoupled * (6 - weak))) continue;
    localizability.directions.col(k) = pure.col(k);
    localizability.pure[k] = true;
  }
  localizability.directions.colwise().normalize();
}

}  // namespace allan_lio
