// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace allan_lio {

/// A plane fitted to points, with what its fit leaves uncertain.
struct Plane {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< mean of the points [m], world
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, world
  /// Principal axes in the plane, world, each times the 1 sigma by which the normal may lean along it [rad]:
  /// cov(normal) = lean_1 lean_1^T + lean_2 lean_2^T.
  Eigen::Vector3d lean_1 = Eigen::Vector3d::Zero();
  Eigen::Vector3d lean_2 = Eigen::Vector3d::Zero();
  double thickness = 0.0;        ///< variance of the points about the plane [m^2]
  double center_variance = 0.0;  ///< variance of the center along the normal [m^2]
  double width = 0.0;            ///< of the points along the shorter axis in the plane [m]
  /// Main direction of the beams that saw the points, unit, world, away from the sensor; zero if unknown.
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
  /// Number of the voxel whose plane it is, so that residuals that share its errors are told; kNoGroup: none.
  std::uint32_t group = kNoGroup;
  std::uint32_t epoch = 0;  ///< of its points, on average; as given to VoxelMap::insert()
  static constexpr std::uint32_t kNoGroup = 0xffffffffU;

  double distance(const Eigen::Vector3d& point) const { return normal.dot(point - center); }

  /// Where the perpendicular from `point` meets the plane.
  Eigen::Vector3d foot(const Eigen::Vector3d& point) const { return point - distance(point) * normal; }

  /// Variance of the plane's height under `point` [m^2].
  double variance_at(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d offset = point - center;
    const double a = lean_1.dot(offset), b = lean_2.dot(offset);
    return center_variance + a * a + b * b;
  }
};

/// Of the angle of incidence, 8 deg from grazing: below it nothing is known of a beam's spot.
constexpr double kLeastSquaredCosine = 0.02;

/// Sums over points about a fixed origin near them, from which the plane follows.
struct PlaneSums {
  using Products = Eigen::Matrix<double, 6, 1>;  ///< xx xy xz yy yz zz

  Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< [m]
  Products products = Products::Zero();           ///< of the points [m^2]
  Products beams = Products::Zero();  ///< of the unit vectors along which they were seen, as far as these are known
  std::uint32_t count = 0;

  void add(const Eigen::Vector3d& p) {
    sum += p;
    add_products(p, products);
    ++count;
  }
  void add(const Eigen::Vector3d& p, const Eigen::Vector3d& beam) {
    add(p);
    add_products(beam, beams);
  }

 private:
  static void add_products(const Eigen::Vector3d& p, Products& to) {
    to[0] += p.x() * p.x();
    to[1] += p.x() * p.y();
    to[2] += p.x() * p.z();
    to[3] += p.y() * p.y();
    to[4] += p.y() * p.z();
    to[5] += p.z() * p.z();
  }
};

struct PlaneLimits {
  double point_variance;  ///< of one point along its beam: the range noise's [m^2]
  double max_structure;   ///< 1 sigma of the points about the plane, beyond the range noise [m]
  double max_lean;        ///< 1 sigma of the normal [rad]
  /// Least ratio of the spread inside the plane to the noise across it, as standard deviations: a strip narrower
  /// than its noise would pass for a plane across itself.
  double least_aspect;
  std::uint32_t min_points;
  std::uint32_t max_independent;  ///< more points than this are not taken for more information: they share poses
};

/// Fits the plane; false if the points do not make one within the limits. `origin` is what the sums are about. The
/// view's sign is left to the caller.
bool fit_plane(const PlaneSums& sums, const Eigen::Vector3d& origin, const PlaneLimits& limits, Plane& plane);

}  // namespace allan_lio
