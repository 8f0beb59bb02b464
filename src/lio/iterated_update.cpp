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
constexpr double kViewTime = 2.0;   ///< [s] in which other planes come into view
constexpr double kSupported = 0.5;  ///< support from which a direction counts as measured

/// What the residuals see: pose, extrinsics, view.
constexpr int kTouched = kResidualDof + 6;
using TouchedMatrix = Eigen::Matrix<double, kTouched, kTouched>;
using TouchedVector = Eigen::Matrix<double, kTouched, 1>;

PoseMatrix pose_block(const LioMatrix& covariance, const PoseRows& rows) {
  ResidualMatrix block;
  block << covariance.topLeftCorner<6, 6>(), covariance.block<6, 6>(0, kExtrinsicRotation),
      covariance.block<6, 6>(kExtrinsicRotation, 0), covariance.block<6, 6>(kExtrinsicRotation, kExtrinsicRotation);
  return rows * block * rows.transpose();
}

/// Covariance of the LiDAR's pose relative to the planes in view.
PoseMatrix relative_covariance(const Belief& belief, const PoseRows& rows) {
  const PoseMatrix mixed = rows.leftCols<6>() * belief.view.cross.topRows<6>() +
                           rows.rightCols<6>() * belief.view.cross.middleRows<6>(kExtrinsicRotation);
  return pose_block(belief.covariance, rows) + belief.view.own - mixed - mixed.transpose();
}

/// What the prediction leaves uncertain. `duration` of the scan [s], 0 if it is not deskewed: a point's age has the
/// mean square duration^2/3.
ScanUncertainty scan_uncertainty(const Belief& belief, const PoseRows& rows, double duration) {
  const double age = duration * duration / 3.0;
  const PoseMatrix pose = relative_covariance(belief, rows);
  return {pose, pose, age * belief.covariance.block<3, 3>(kVelocity, kVelocity),
          age * belief.covariance.diagonal().segment<3>(kGyroBias).maxCoeff()};
}

Localizability judge(const NormalEquations& equations, const PointToPlane& residuals,
                     const std::vector<Eigen::Vector3f>& points, const LioState& state, double floor) {
  const PoseMatrix information = equations.information.topLeftCorner<6, 6>();
  const double scale = std::sqrt(equations.squared_range / equations.inliers);
  const PoseMatrix directions = support_directions(information, equations.feigned, scale);
  PoseMatrix unscaled = directions;
  unscaled.topRows<3>() /= scale;
  return judge_localizability(information, equations.feigned, directions,
                              residuals.squares_along(points, state, unscaled), scale, floor);
}

/// Covariance of the planes' own errors as an error of the pose, along what the scan supports.
PoseMatrix view_noise(const NormalEquations& equations, const Localizability& localizability) {
  PoseMatrix inverse = PoseMatrix::Zero();
  for (int k = 0; k < 6; ++k) {
    if (localizability.support[k] < kSupported) continue;
    PoseVector direction = localizability.directions.col(k);
    direction.head<3>() /= localizability.scale;
    inverse +=
        direction * direction.transpose() / direction.dot(equations.information.topLeftCorner<6, 6>() * direction);
  }
  return inverse * equations.plane_scatter * inverse;
}

/// Leaves to the IMU what the scan does not support.
NormalEquations weigh(const NormalEquations& equations, const PoseMatrix& support, const PoseRows& rows) {
  NormalEquations out = equations;
  const PoseMatrix information = support * equations.information.topLeftCorner<6, 6>();
  out.information.topLeftCorner<6, 6>() = 0.5 * (information + information.transpose());
  out.gradient.head<6>() = support * equations.gradient.head<6>();
  out.spread(rows);
  return out;
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
  const LioConfig::Lidar& lidar = config.lidar;
  return {lidar.range_noise * lidar.range_noise,
          config.update.gate,
          config.update.robust_scale,
          config.estimate_extrinsics,
          lidar.k_r,
          lidar.beam_divergence};
}

UpdateStep solve_step(const LioState& iterate, const LioState& prior, const Belief& belief,
                      const NormalEquations& equations, bool estimate_extrinsics) {
  const LioMatrix to_iterate = transport(iterate, prior);
  const LioMatrix p = to_iterate * belief.covariance * to_iterate.transpose();
  const Eigen::Matrix<double, kLioDof, 6> cross = to_iterate * belief.view.cross;
  const LioVector pull = -to_iterate * lio_minus(iterate, prior);

  Eigen::Matrix<double, kLioDof, kTouched> touched;
  touched << p.leftCols<6>(), p.middleCols<6>(kExtrinsicRotation), cross;
  Eigen::Matrix<double, kTouched, 6> with_view;
  with_view << cross.topRows<6>(), cross.middleRows<6>(kExtrinsicRotation), belief.view.own;
  TouchedMatrix seen;
  seen << touched.topRows<6>(), touched.middleRows<6>(kExtrinsicRotation), with_view.transpose();
  TouchedVector pulled;
  pulled << pull.head<6>(), pull.segment<6>(kExtrinsicRotation), PoseVector::Zero();

  // One gradient of the pose, as those of pose, extrinsics and view.
  Eigen::Matrix<double, kTouched, 6> spread;
  spread << lidar_pose_rows(iterate, estimate_extrinsics).transpose(), -PoseMatrix::Identity();
  TouchedMatrix information;
  information << equations.information, -equations.information.leftCols<6>(), -equations.information.topRows<6>(),
      equations.information.topLeftCorner<6, 6>();
  TouchedVector gradient;
  gradient << equations.gradient, -equations.gradient.head<6>();

  const Eigen::PartialPivLU<TouchedMatrix> lu(TouchedMatrix::Identity() + information * seen);
  UpdateStep out;
  out.step = pull + touched * lu.solve(gradient - information * pulled);
  const LioMatrix updated = p - touched * lu.solve(information * touched.transpose());
  out.posterior.covariance = 0.5 * (updated + updated.transpose());
  out.posterior.view.cross = cross - touched * lu.solve(information * with_view);
  out.posterior.view.own = belief.view.own;
  out.gain = touched * lu.solve(spread);
  return out;
}

UpdateReport iterated_update(const std::vector<Eigen::Vector3f>& points_imu, const VoxelMap& map,
                             const LioConfig& config, const ScanTimes& times, PointToPlane& residuals, LioState& state,
                             Belief& belief, AbsoluteCovariance& absolute) {
  const ResidualOptions options = residual_options(config);
  const bool estimate = config.estimate_extrinsics;
  ScanUncertainty uncertainty = scan_uncertainty(belief, lidar_pose_rows(state, estimate), times.smeared);
  const std::vector<std::uint32_t> last_epochs = absolute.last_epochs();
  const LioState prior = state;
  const Belief before = belief;
  Belief prior_belief = belief;  // the view has changed since
  UsedMeasurement used;
  used.view_kept = std::exp(-times.since_update / kViewTime);

  UpdateReport report;
  LioState iterate = prior;
  std::vector<Eigen::Vector3f> moved;
  for (int i = 0; i < config.update.max_iterations; ++i) {
    const auto& points = moved_points(points_imu, iterate, prior, estimate, moved);
    const NormalEquations equations = residuals.linearize(points, iterate, uncertainty, map, options, last_epochs);
    if (equations.inliers < kLeastInliers) {
      belief = before;
      return UpdateReport{};
    }
    report.localizability = judge(equations, residuals, points, iterate, config.update.support_floor);
    used.support = support_factor(report.localizability);
    if (i == 0) {
      used.view_noise = view_noise(equations, report.localizability);
      prior_belief.view.change(used.view_kept, used.view_noise);
      report.innovation = pose_innovation(equations.information.topLeftCorner<6, 6>(), equations.gradient.head<6>(),
                                          uncertainty.pose, report.localizability);
    }
    const UpdateStep solution = solve_step(
        iterate, prior, prior_belief, weigh(equations, used.support, lidar_pose_rows(iterate, estimate)), estimate);
    const LioState next = lio_plus(iterate, solution.step);
    const LioMatrix reset = transport(next, iterate);
    report.iterations = i + 1;
    report.inliers = equations.inliers;
    report.residual_rms = std::sqrt(equations.squared_distance / equations.inliers);
    used.state = iterate;
    used.gain = solution.gain;
    used.parts = residuals.information_of_parts();
    belief.covariance = reset * solution.posterior.covariance * reset.transpose();
    belief.view = {reset * solution.posterior.view.cross, solution.posterior.view.own};
    iterate = next;
    uncertainty.iterate = relative_covariance(belief, lidar_pose_rows(iterate, estimate));
    if (converged(solution.step, config.update)) break;
  }
  absolute.transform(transport(used.state, prior));
  absolute.update(used, estimate);
  absolute.transform(transport(iterate, used.state));
  state = iterate;
  report.applied = true;
  return report;
}

}  // namespace allan_lio
