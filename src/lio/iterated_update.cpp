// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/iterated_update.h"

#include <Eigen/LU>
#include <cmath>

#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr int kLeastInliers = 20;

/// Rows of the error state that the residuals touch.
Eigen::Matrix<double, kLioDof, kResidualDof> touched_columns(const LioMatrix& m) {
  Eigen::Matrix<double, kLioDof, kResidualDof> out;
  out << m.leftCols<6>(), m.middleCols<6>(kExtrinsicRotation);
  return out;
}

ResidualMatrix touched_block(const Eigen::Matrix<double, kLioDof, kResidualDof>& columns) {
  ResidualMatrix out;
  out << columns.topRows<6>(), columns.middleRows<6>(kExtrinsicRotation);
  return out;
}

/// Leaves to the IMU what the scan does not support.
Localizability weigh_by_support(double floor, const PoseRows& rows, NormalEquations& equations) {
  const double scale = std::sqrt(equations.squared_range / equations.inliers);
  const Localizability localizability =
      judge_localizability(equations.information.topLeftCorner<6, 6>(), equations.feigned, scale, floor);
  const PoseMatrix factor = support_factor(localizability);
  equations.information.topLeftCorner<6, 6>() =
      factor * equations.information.topLeftCorner<6, 6>().eval() * factor.transpose();
  equations.gradient.head<6>() = factor * factor * equations.gradient.head<6>().eval();
  equations.spread(rows);
  return localizability;
}

/// The points as they lie with the iterate's extrinsics; they were deskewed with the prior's.
const std::vector<Eigen::Vector3f>& moved_points(const std::vector<Eigen::Vector3f>& points, const LioState& iterate,
                                                 const LioState& prior, bool estimate_extrinsics,
                                                 std::vector<Eigen::Vector3f>& moved) {
  if (!estimate_extrinsics) return points;
  const RigidTransform change = iterate.T_imu_lidar * prior.T_imu_lidar.inverse();
  moved.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) moved[i] = (change * points[i].cast<double>()).cast<float>();
  return moved;
}

bool converged(const LioVector& step, const LioConfig::Update& options) {
  return step.segment<3>(kTheta).norm() < options.rotation_tolerance &&
         step.segment<3>(kPosition).norm() < options.translation_tolerance;
}

}  // namespace

LioState lio_plus(const LioState& x, const LioVector& delta) {
  LioState y;
  y.nav = nav_plus(x.nav, delta.head<kNavDof>());
  y.T_imu_lidar.rotation = (x.T_imu_lidar.rotation * exp_so3(delta.segment<3>(kExtrinsicRotation))).normalized();
  y.T_imu_lidar.translation = x.T_imu_lidar.translation + delta.segment<3>(kExtrinsicTranslation);
  return y;
}

LioVector lio_minus(const LioState& y, const LioState& x) {
  LioVector delta;
  delta.head<kNavDof>() = nav_minus(y.nav, x.nav);
  delta.segment<3>(kExtrinsicRotation) = log_so3(x.T_imu_lidar.rotation.conjugate() * y.T_imu_lidar.rotation);
  delta.segment<3>(kExtrinsicTranslation) = y.T_imu_lidar.translation - x.T_imu_lidar.translation;
  return delta;
}

LioMatrix transport(const LioState& y, const LioState& x) {
  const LioVector delta = lio_minus(y, x);
  LioMatrix out = LioMatrix::Identity();
  out.block<3, 3>(kTheta, kTheta) = right_jacobian(delta.segment<3>(kTheta));
  out.block<2, 2>(kGravity, kGravity) = s2_minus_jacobian(y.nav.gravity_world, x.nav.gravity_world).inverse();
  out.block<3, 3>(kExtrinsicRotation, kExtrinsicRotation) = right_jacobian(delta.segment<3>(kExtrinsicRotation));
  return out;
}

ResidualOptions residual_options(const LioConfig& config) {
  const double range_sigma = config.lidar.k_r * config.lidar.range_noise;
  return {range_sigma * range_sigma, config.update.gate, config.update.robust_scale, config.estimate_extrinsics};
}

UpdateStep solve_step(const LioState& iterate, const LioState& prior, const LioMatrix& prior_covariance,
                      const NormalEquations& equations) {
  const LioMatrix to_iterate = transport(iterate, prior);
  const LioMatrix p = to_iterate * prior_covariance * to_iterate.transpose();
  const LioVector pull = -to_iterate * lio_minus(iterate, prior);

  const ResidualMatrix& information = equations.information;
  const auto p_touched = touched_columns(p);
  const ResidualMatrix system = ResidualMatrix::Identity() + information * touched_block(p_touched);
  const Eigen::PartialPivLU<ResidualMatrix> lu(system);
  ResidualVector pull_touched;
  pull_touched << pull.head<6>(), pull.segment<6>(kExtrinsicRotation);

  UpdateStep out;
  out.step = pull + p_touched * lu.solve(equations.gradient - information * pull_touched);
  const LioMatrix updated = p - p_touched * lu.solve(information * p_touched.transpose());
  out.covariance = 0.5 * (updated + updated.transpose());
  return out;
}

UpdateReport iterated_update(const std::vector<Eigen::Vector3f>& points_imu, const VoxelMap& map,
                             const LioConfig& config, PointToPlane& residuals, LioState& state, LioMatrix& covariance) {
  const ResidualOptions options = residual_options(config);
  const bool estimate = config.estimate_extrinsics;
  const PoseRows prior_rows = lidar_pose_rows(state, estimate);
  const PoseMatrix pose_covariance = prior_rows * touched_block(touched_columns(covariance)) * prior_rows.transpose();
  const LioState prior = state;
  const LioMatrix prior_covariance = covariance;

  UpdateReport report;
  LioState iterate = prior;
  std::vector<Eigen::Vector3f> moved;
  for (int i = 0; i < config.update.max_iterations; ++i) {
    const auto& points = moved_points(points_imu, iterate, prior, estimate, moved);
    NormalEquations equations = residuals.linearize(points, iterate, pose_covariance, map, options);
    if (equations.inliers < kLeastInliers) {
      covariance = prior_covariance;
      return UpdateReport{};
    }
    const PoseMatrix information = equations.information.topLeftCorner<6, 6>();
    const PoseVector gradient = equations.gradient.head<6>();
    report.localizability =
        weigh_by_support(config.update.support_floor, lidar_pose_rows(iterate, estimate), equations);
    if (i == 0) report.innovation = pose_innovation(information, gradient, pose_covariance, report.localizability);
    const UpdateStep solution = solve_step(iterate, prior, prior_covariance, equations);
    const LioState next = lio_plus(iterate, solution.step);
    const LioMatrix reset = transport(next, iterate);
    covariance = reset * solution.covariance * reset.transpose();
    iterate = next;
    report.iterations = i + 1;
    report.inliers = equations.inliers;
    report.residual_rms = std::sqrt(equations.squared_distance / equations.inliers);
    if (converged(solution.step, config.update)) break;
  }
  state = iterate;
  report.applied = true;
  return report;
}

}  // namespace allan_lio
