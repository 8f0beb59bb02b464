// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/iterated_update.h"

#include <cmath>

#include "allan_lio/lio/decouple.h"
#include "pose_error.h"
#include "transported.h"

namespace allan_lio {
namespace {

constexpr int kLeastInliers = 20;
constexpr double kViewTime = 2.0;  ///< [s] in which other planes come into view

/// What the prediction leaves uncertain: a point's age has the mean square duration^2/3. (What the gyroscope's noise
/// does to all points alike is in ScanError; by a sixth of it they deviate from that.)
ScanUncertainty scan_uncertainty(const Belief& belief, const ScanError& scan, const PoseRows& rows,
                                 const ScanConditions& conditions) {
  const double age = conditions.deskewed * conditions.deskewed / 3.0;
  const PoseMatrix pose = relative_covariance(belief.covariance, seen_error(belief.view, scan), rows);
  return {pose,
          {},  // known to the absolute covariance alone
          pose,
          age * belief.covariance.block<3, 3>(kVelocity, kVelocity),
          age * belief.covariance.diagonal().segment<3>(kGyroBias).maxCoeff() +
              conditions.deskewed / 6.0 * conditions.gyro_psd.maxCoeff()};
}

Localizability judge(const NormalEquations& equations, PointToPlane& residuals,
                     const std::vector<Eigen::Vector3f>& points, const LioState& state, double floor) {
  const PoseMatrix information = equations.information.topLeftCorner<6, 6>();
  Localizability found;
  found.scale = std::sqrt(equations.squared_range / equations.inliers);
  found.directions = support_directions(information, equations.feigned, found.scale);
  const PoseVector squares = residuals.squares_along(points, state, found);
  found = judge_localizability(information, equations.feigned, found.directions, squares, found.scale, floor);
  decouple(
      information, equations.feigned,
      [&](const PoseVector& direction) { return residuals.coupling_noise(points, state, direction); }, found);
  return found;
}

/// Covariance of the planes' own errors as an error of the pose, along what the scan supports.
PoseMatrix view_noise(const NormalEquations& equations, const Localizability& localizability) {
  const PoseMatrix directions = unscaled_directions(localizability);
  PoseMatrix inverse = PoseMatrix::Zero();
  for (int k = 0; k < 6; ++k) {
    if (localizability.support[k] < kSupported) continue;
    const PoseVector direction = directions.col(k);
    inverse +=
        direction * direction.transpose() / direction.dot(equations.information.topLeftCorner<6, 6>() * direction);
  }
  return inverse * equations.plane_scatter * inverse;
}

/// Leaves to the IMU what the scan does not support.
NormalEquations weigh(const NormalEquations& equations, const Localizability& localizability, const PoseRows& rows) {
  NormalEquations out = equations;
  out.information.topLeftCorner<6, 6>() =
      weighed_information(equations.information.topLeftCorner<6, 6>(), localizability);
  out.gradient.head<6>() = support_factor(localizability) * equations.gradient.head<6>();
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

/// Of two steps of the pose: nearer to each other than half the second one.
bool is_near(const PoseVector& step, const PoseVector& proposed) {
  return in_metres(step - proposed).norm() < 0.5 * in_metres(proposed).norm();
}

bool converged(const LioVector& step, const LioConfig::Update& options) {
  return step.segment<3>(kTheta).norm() < options.rotation_tolerance &&
         step.segment<3>(kPosition).norm() < options.translation_tolerance;
}

}  // namespace

ResidualOptions residual_options(const LioConfig& config) {
  const LioConfig::Lidar& lidar = config.lidar;
  return {lidar.range_noise * lidar.range_noise,
          config.update.gate,
          config.update.robust_scale,
          config.estimate_extrinsics,
          lidar.k_r,
          lidar.beam_divergence};
}

UpdateReport iterated_update(const std::vector<Eigen::Vector3f>& points_imu, const VoxelMap& map,
                             const LioConfig& config, const ScanConditions& conditions, PointToPlane& residuals,
                             LioState& state, Belief& belief, AbsoluteCovariance& absolute) {
  const ResidualOptions options = residual_options(config);
  const bool estimate = config.estimate_extrinsics;
  const ScanError scan = deskewing_error(conditions.deskewed, conditions.gyro_psd);
  ScanUncertainty uncertainty = scan_uncertainty(belief, scan, lidar_pose_rows(state, estimate), conditions);
  const std::vector<std::uint32_t> last_epochs = absolute.last_epochs();
  uncertainty.parts = absolute.relative_to_parts(state, estimate);
  const LioState prior = state;
  const Belief before = belief;
  LioState iterate = prior;
  UpdateReport report;
  std::optional<AbsoluteCovariance> absolute_before;
  if (conditions.place) {  // then both covariances are to know of this error
    absolute_before = absolute;
    const LioVector error = state_error(conditions.place->step);
    belief.covariance +=
        surprise(conditions.place->step, belief.covariance.topLeftCorner<6, 6>()) * error * error.transpose();
    absolute.add_surprise(conditions.place->step, state, conditions.place->last_epoch);
    uncertainty = scan_uncertainty(belief, scan, lidar_pose_rows(state, estimate), conditions);
    uncertainty.parts = absolute.relative_to_parts(state, estimate);
    iterate = lio_plus(prior, error);
  }
  Belief prior_belief = belief;  // the view has changed since
  UsedMeasurement used;
  used.view_kept = std::exp(-conditions.since_update / kViewTime);
  used.scan = scan;

  std::vector<Eigen::Vector3f> moved;
  for (int i = 0; i < config.update.max_iterations; ++i) {
    const auto& points = moved_points(points_imu, iterate, prior, estimate, moved);
    const NormalEquations equations = residuals.linearize(points, iterate, uncertainty, map, options, last_epochs);
    if (equations.inliers < kLeastInliers) {
      belief = before;
      if (absolute_before) absolute = *absolute_before;
      return UpdateReport{};
    }
    report.localizability = judge(equations, residuals, points, iterate, config.update.support_floor);
    used.support = support_factor(report.localizability);
    if (i == 0) {
      used.view_noise = view_noise(equations, report.localizability);
      prior_belief.view.change(used.view_kept, used.view_noise);
      if (!conditions.place)  // else the gradient is not the prediction's
        report.innovation = pose_innovation(equations.information.topLeftCorner<6, 6>(), equations.gradient.head<6>(),
                                            uncertainty.pose, report.localizability);
    }
    const UpdateStep solution =
        solve_step(iterate, prior, prior_belief, scan,
                   weigh(equations, report.localizability, lidar_pose_rows(iterate, estimate)), estimate);
    const LioState next = lio_plus(iterate, solution.step);
    const LioMatrix reset = transport(next, iterate);
    report.iterations = i + 1;
    report.inliers = equations.inliers;
    report.residual_rms = std::sqrt(equations.squared_distance / equations.inliers);
    used.state = iterate;
    report.measurement = {iterate.nav,
                          equations.information.topLeftCorner<6, 6>(),
                          equations.gradient.head<6>(),
                          used.view_noise,
                          used.view_kept,
                          conditions.deskewed};
    used.gain = solution.gain;
    used.parts = residuals.information_of_parts();
    for (PoseMatrix& part : used.parts) part = (part * without_pure(report.localizability)).eval();
    belief.covariance = transported(reset, solution.posterior.covariance);
    belief.view = solution.posterior.view;
    transport_rows(reset, belief.view.cross);
    iterate = next;
    uncertainty.iterate = relative_covariance(belief.covariance, belief.view, lidar_pose_rows(iterate, estimate));
    if (converged(solution.step, config.update)) break;
  }
  absolute.move(transport(used.state, prior));
  absolute.update(used, estimate);
  absolute.move(transport(iterate, used.state));
  report.relocated = conditions.place && is_near(lio_minus(iterate, prior).head<6>(), conditions.place->step);
  state = iterate;
  report.applied = true;
  return report;
}

}  // namespace allan_lio
