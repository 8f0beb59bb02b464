// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/localizability.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

constexpr double kEnough = 8.0;         ///< things that hold a direction up: one of fewer could be an artefact
constexpr double kLeastFeigned = 1e-3;  ///< [1/m^2]: information for less than 30 m of uncertainty is none

/// Rotations in metres at the scene's size.
PoseVector to_metres(double scale) {
  PoseVector out;
  out << scale, scale, scale, 1.0, 1.0, 1.0;
  return out;
}

/// Information about the pose in metres.
PoseMatrix in_metres(const PoseMatrix& information, double scale) {
  const PoseVector inverse = to_metres(scale).cwiseInverse();
  return inverse.asDiagonal() * information * inverse.asDiagonal();
}

PoseMatrix feigned_in_metres(const PoseMatrix& feigned, double scale) {
  return in_metres(feigned, scale) + kLeastFeigned * PoseMatrix::Identity();
}

/// Probability that the true ratio is above `floor`, where one of `ratio` was found on so many things.
double probability_above(double floor, double ratio, double things) {
  if (ratio <= 0.0) return 0.0;
  return 0.5 * std::erfc(-std::sqrt(0.5 * things) * (1.0 - floor / ratio));
}

}  // namespace

PoseMatrix support_directions(const PoseMatrix& information, const PoseMatrix& feigned, double scale) {
  const Eigen::LLT<PoseMatrix> root(feigned_in_metres(feigned, scale));
  PoseMatrix ratio = root.matrixL().solve(in_metres(information, scale));
  ratio = root.matrixL().solve(ratio.transpose().eval());
  const Eigen::SelfAdjointEigenSolver<PoseMatrix> solver(0.5 * (ratio + ratio.transpose()));
  PoseMatrix directions = root.matrixL().transpose().solve(solver.eigenvectors());
  directions.colwise().normalize();
  return directions;
}

Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned,
                                    const PoseMatrix& directions, const PoseVector& squares, double scale,
                                    double floor) {
  const PoseMatrix all = in_metres(information, scale), noise = feigned_in_metres(feigned, scale);
  Localizability out;
  out.scale = scale;
  out.directions = directions;
  for (int k = 0; k < 6; ++k) {
    const PoseVector x = directions.col(k);
    const double found = x.dot(all * x), ratio = found / x.dot(noise * x);
    const double things = squares[k] > 0.0 ? found * found / squares[k] : 1e12;
    out.probability[k] = probability_above(floor, ratio, things);
    const double enough = std::min(1.0, things / kEnough);
    out.support[k] = ratio > 1.0 ? out.probability[k] * (1.0 - 1.0 / ratio) * enough * enough : 0.0;
  }
  return out;
}

Localizability judge_localizability(const PoseMatrix& information, const PoseMatrix& feigned, double scale,
                                    double floor) {
  return judge_localizability(information, feigned, support_directions(information, feigned, scale), PoseVector::Zero(),
                              scale, floor);
}

PoseMatrix unscaled_directions(const Localizability& localizability) {
  return to_metres(localizability.scale).cwiseInverse().asDiagonal() * localizability.directions;
}

PoseMatrix support_factor(const Localizability& localizability) {
  const PoseMatrix x = unscaled_directions(localizability);
  return x.transpose().partialPivLu().solve(PoseMatrix(localizability.support.asDiagonal() * x.transpose()));
}

PoseMatrix weighed_information(const PoseMatrix& information, const Localizability& localizability) {
  const PoseMatrix x = unscaled_directions(localizability), dual = x.inverse();
  const PoseVector along = (x.transpose() * information * x).diagonal().cwiseProduct(localizability.support);
  const PoseMatrix out = dual.transpose() * along.asDiagonal() * dual;
  return 0.5 * (out + out.transpose());
}

PoseMatrix without_pure(const Localizability& localizability) {
  const PoseMatrix x = unscaled_directions(localizability);
  PoseVector kept = PoseVector::Ones();
  for (int k = 0; k < 6; ++k)
    if (localizability.pure[k]) kept[k] = 0.0;
  return x * kept.asDiagonal() * x.inverse();
}

}  // namespace allan_lio
