// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/update_step.h"

#include <Eigen/LU>

#include "allan_lio/lio/bias_mean.h"
#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"
#include "transported.h"

namespace allan_lio {
namespace {

/// What the residuals see: pose, extrinsics, and the errors beside the pose.
constexpr int kTouched = kResidualDof + 6;
using TouchedMatrix = Eigen::Matrix<double, kTouched, kTouched>;
using TouchedVector = Eigen::Matrix<double, kTouched, 1>;

PoseMatrix pose_block(const LioMatrix& covariance, const PoseRows& rows) {
  ResidualMatrix block;
  block << covariance.topLeftCorner<6, 6>(), covariance.block<6, 6>(0, kExtrinsicRotation),
      covariance.block<6, 6>(kExtrinsicRotation, 0), covariance.block<6, 6>(kExtrinsicRotation, kExtrinsicRotation);
  return rows * block * rows.transpose();
}

}  // namespace

LioState lio_plus(const LioState& x, const LioVector& delta) {
  LioState y;
  y.nav = nav_plus(x.nav, delta.head<kNavDof>());
  y.T_imu_lidar.rotation = (x.T_imu_lidar.rotation * exp_so3(delta.segment<3>(kExtrinsicRotation))).normalized();
  y.T_imu_lidar.translation = x.T_imu_lidar.translation + delta.segment<3>(kExtrinsicTranslation);
  y.nav.gyro_bias_mean += delta.segment<3>(kGyroBiasMean);
  y.nav.accel_bias_mean += delta.segment<3>(kAccelBiasMean);
  return y;
}

LioVector lio_minus(const LioState& y, const LioState& x) {
  LioVector delta;
  delta.head<kInertialDof>() = inertial_minus(y.nav, x.nav);
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

ViewError seen_error(const ViewError& view, const ScanError& scan) {
  return {view.cross + scan.with_state, view.own + scan.noise};
}

PoseMatrix relative_covariance(const LioMatrix& covariance, const ViewError& seen, const PoseRows& rows) {
  const PoseMatrix mixed =
      rows.leftCols<6>() * seen.cross.topRows<6>() + rows.rightCols<6>() * seen.cross.middleRows<6>(kExtrinsicRotation);
  return pose_block(covariance, rows) + seen.own - mixed - mixed.transpose();
}

UpdateStep solve_step(const LioState& iterate, const LioState& prior, const Belief& belief, const ScanError& scan,
                      const NormalEquations& equations, bool estimate_extrinsics) {
  const LioMatrix to_iterate = transport(iterate, prior);
  const LioMatrix p = transported(to_iterate, belief.covariance);
  const ViewError error = seen_error(belief.view, scan);
  Eigen::Matrix<double, kLioDof, 6> cross = error.cross, of_view = belief.view.cross;
  transport_rows(to_iterate, cross);
  transport_rows(to_iterate, of_view);
  const LioVector pull = -to_iterate * lio_minus(iterate, prior);

  Eigen::Matrix<double, kLioDof, kTouched> touched;
  touched << p.leftCols<6>(), p.middleCols<6>(kExtrinsicRotation), cross;
  Eigen::Matrix<double, kTouched, 6> with_view;
  with_view << of_view.topRows<6>(), of_view.middleRows<6>(kExtrinsicRotation), belief.view.own;
  TouchedMatrix seen;
  seen << touched.topRows<6>(), touched.middleRows<6>(kExtrinsicRotation), cross.topRows<6>().transpose(),
      cross.middleRows<6>(kExtrinsicRotation).transpose(), error.own;
  TouchedVector pulled;
  pulled << pull.head<6>(), pull.segment<6>(kExtrinsicRotation), PoseVector::Zero();

  // One gradient of the pose, as those of pose, extrinsics and what is seen beside it.
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
  out.posterior.view.cross = of_view - touched * lu.solve(information * with_view);
  out.posterior.view.own = belief.view.own;
  out.gain = touched * lu.solve(spread);
  return out;
}

}  // namespace allan_lio
