// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace allan_lio {
namespace {

/// What a voxel's points deviate by beyond the range noise is structure (a rib, a step, a curve), and which part of it
/// a scan shows hangs together: it counts as so many independent samples, however many points there are.
constexpr double kStructures = 4.0;

Eigen::Matrix3d matrix_of(const PlaneSums::Products& s) {
  Eigen::Matrix3d out;
  out << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return out;
}

/// What the range noise makes of the points along the normal, as they were seen.
double expected_variance(const PlaneSums& sums, const Eigen::Vector3d& normal, double point_variance) {
  if (sums.beams.isZero()) return point_variance;
  const double squared_cosine = normal.dot(matrix_of(sums.beams) * normal) / sums.count;
  return point_variance * std::max(squared_cosine, kLeastSquaredCosine);
}

/// The largest axis of the beams' products, by two steps of power iteration: they lie within some degrees.
Eigen::Vector3d main_beam(const PlaneSums& sums) {
  if (sums.beams.isZero()) return Eigen::Vector3d::Zero();
  const Eigen::Matrix3d beams = matrix_of(sums.beams);
  int largest = 0;
  beams.diagonal().maxCoeff(&largest);
  return (beams * (beams * beams.col(largest))).normalized();
}

}  // namespace

bool fit_plane(const PlaneSums& sums, const Eigen::Vector3d& origin, const PlaneLimits& limits, Plane& plane) {
  if (sums.count < limits.min_points) return false;
  const double n = sums.count;
  const Eigen::Vector3d mean = sums.sum / n;
  const Eigen::Matrix3d scatter = matrix_of(sums.products) / n - mean * mean.transpose();

  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter);
  const Eigen::Vector3d& spread = solver.eigenvalues();  // ascending
  const double degrees_of_freedom = n / (n - 3.0);
  const double thickness = std::max(spread[0], 0.0) * degrees_of_freedom;
  if (!(thickness <= limits.point_variance + limits.max_structure * limits.max_structure)) return false;

  // Regression of height on the two in-plane coordinates: variances of the offset and of the two slopes.
  if (spread[1] < limits.least_aspect * limits.least_aspect * std::max(thickness, limits.point_variance)) return false;
  const double expected = expected_variance(sums, solver.eigenvectors().col(0), limits.point_variance);
  const double noise = std::max(thickness, expected);
  // One deviation of the estimated thickness may well be the range noise's.
  const double structure = std::max(0.0, thickness - expected * (1.0 + std::sqrt(2.0 / n)));
  const double center_variance = noise / std::min<double>(n, limits.max_independent) + structure / kStructures;
  const double lean_1 = std::sqrt(center_variance / spread[2]);
  const double lean_2 = std::sqrt(center_variance / spread[1]);
  if (!(lean_2 <= limits.max_lean)) return false;

  plane.center = origin + mean;
  plane.normal = solver.eigenvectors().col(0);
  plane.lean_1 = lean_1 * solver.eigenvectors().col(2);
  plane.lean_2 = lean_2 * solver.eigenvectors().col(1);
  plane.thickness = thickness;
  plane.center_variance = center_variance;
  plane.width = std::sqrt(12.0 * spread[1]);  // of an even strip
  plane.view = main_beam(sums);
  return true;
}

}  // namespace allan_lio
