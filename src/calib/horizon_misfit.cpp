// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "horizon_misfit.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kLog2Pi = 1.83787706640934548356;

}  // namespace

SupportedAxes supported_axes(const Localizability& localizability) {
  PoseVector to_metres = PoseVector::Ones();
  to_metres.head<3>().setConstant(localizability.scale);
  const PoseMatrix& x = localizability.directions;
  const PoseMatrix to_y = x.inverse() * to_metres.asDiagonal();
  SupportedAxes axes;
  for (int k = 0; k < 6; ++k)
    if (localizability.support[k] >= kSupported) axes.directions[axes.count++] = k;
  axes.rows.resize(axes.count, 6);
  SupportedMatrix gram(axes.count, axes.count);
  for (int i = 0; i < axes.count; ++i) {
    axes.rows.row(i) = to_y.row(axes.directions[i]);
    for (int j = 0; j < axes.count; ++j) gram(i, j) = x.col(axes.directions[i]).dot(x.col(axes.directions[j]));
  }
  if (axes.count > 0) axes.log_gram = std::log(gram.determinant());
  return axes;
}

HorizonMisfit horizon_misfit(const SupportedVector& error, const SupportedMatrix& predicted,
                             const SupportedMatrix& known, double log_gram, double seconds, double least_gain) {
  HorizonMisfit misfit;
  misfit.dof = static_cast<int>(error.size());
  if (misfit.dof == 0) return misfit;
  // Whitened by the prediction's covariance the difference of the two is 1 - known.
  const Eigen::LLT<SupportedMatrix> root(predicted);
  const auto lower = root.matrixL();
  const SupportedMatrix half = lower.solve(known), whitened_known = lower.solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<SupportedMatrix> solver(SupportedMatrix::Identity(misfit.dof, misfit.dof) -
                                                              0.5 * (whitened_known + whitened_known.transpose()));
  const SupportedVector gain = solver.eigenvalues().cwiseMax(least_gain);
  const SupportedVector whitened = solver.eigenvectors().transpose() * lower.solve(error);
  misfit.nis = (whitened.array().square() / gain.array()).sum();
  const double log_det =
      gain.array().log().sum() + 2.0 * SupportedMatrix(lower).diagonal().array().log().sum() + log_gram;
  misfit.nll = 0.5 * (misfit.nis + log_det) + misfit.dof * (0.5 * kLog2Pi - std::log(seconds));
  return misfit;
}

void HorizonSums::add(const HorizonMisfit& misfit, double end) {
  constexpr double kWeight = 1.0 / kBeginsPerHorizon;
  if (misfit.dof == 0) return;
  const bool sane = std::isfinite(misfit.nll) && misfit.nll < HorizonLikelihood::kWorstHorizonNll;
  score_.nll += kWeight * (sane ? misfit.nll : HorizonLikelihood::kWorstHorizonNll);
  if (!std::isfinite(misfit.nis)) return;
  score_.nis += kWeight * misfit.nis;
  score_.dof += kWeight * misfit.dof;
  const auto stretch = static_cast<std::size_t>(end / *std::max_element(kHorizons.begin(), kHorizons.end()));
  if (nis_.size() <= stretch) nis_.resize(stretch + 1), dof_.resize(stretch + 1);
  nis_[stretch] += kWeight * misfit.nis;
  dof_[stretch] += kWeight * misfit.dof;
}

HorizonScore HorizonSums::finish() const {
  HorizonScore score = score_;
  if (nis_.size() < HorizonLikelihood::kFewestStretches || !(score.nis > 0.0)) return score;
  const double mean = score.nis / score.dof;
  double square = 0.0;
  for (std::size_t i = 0; i < nis_.size(); ++i) square += std::pow(nis_[i] - mean * dof_[i], 2);
  const double independent = 2.0 * mean * mean * score.dof;
  score.independent_share = square > independent ? independent / square : 1.0;
  return score;
}

}  // namespace allan_lio
