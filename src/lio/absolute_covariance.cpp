// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/absolute_covariance.h"

#include <algorithm>

#include "allan_lio/lio/point_to_plane.h"
#include "allan_lio/math/so3.h"
#include "pose_error.h"
#include "transported.h"

namespace allan_lio {
namespace {

using StateRows = Eigen::Matrix<double, 6, kLioDof>;

/// Takes an error about one point to that about a point `offset` away.
PoseMatrix shift(const Eigen::Vector3d& offset) {
  PoseMatrix out = PoseMatrix::Identity();
  out.block<3, 3>(3, 0) = -skew(offset);
  return out;
}

/// The LiDAR's pose error, as one of the IMU's pose, from the state's.
StateRows pose_rows(const LioState& state, bool estimate_extrinsics) {
  StateRows rows = StateRows::Zero();
  const PoseRows pose = lidar_pose_rows(state, estimate_extrinsics);
  rows.leftCols<6>() = pose.leftCols<6>();
  rows.middleCols<6>(kExtrinsicRotation) = pose.rightCols<6>();
  return rows;
}

/// To rotation and translation in the world.
PoseMatrix to_world(const LioState& state) {
  PoseMatrix out = PoseMatrix::Identity();
  out.topLeftCorner<3, 3>() = state.nav.T_world_imu.rotation.toRotationMatrix();
  return out;
}

}  // namespace

double surprise(const PoseVector& error, const PoseMatrix& covariance) {
  const PoseVector scaled = in_metres(error), direction = in_metres(scaled.normalized());
  return std::max(0.0, 1.0 - direction.dot(covariance * direction) / scaled.squaredNorm());
}

void AbsoluteCovariance::reset(const LioMatrix& covariance) {
  state_ = covariance;
  forget_map();
}

void AbsoluteCovariance::forget_map() {
  cross_ = Cross::Zero(kLioDof, 6);
  own_ = Own::Zero(6, 6);
  parts_.clear();
}

std::vector<std::uint32_t> AbsoluteCovariance::last_epochs() const {
  std::vector<std::uint32_t> out;
  for (const Part& part : parts_) out.push_back(part.last_epoch);
  return out;
}

std::vector<PoseMatrix> AbsoluteCovariance::relative_to_parts(const LioState& state, bool estimate_extrinsics) const {
  const StateRows rows = pose_rows(state, estimate_extrinsics);
  const PoseMatrix from_world = to_world(state).transpose();
  std::vector<PoseMatrix> out;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const int at = column(i);
    const PoseMatrix move = from_world * shift(state.nav.T_world_imu.translation - parts_[i].reference);
    const PoseMatrix mixed = rows * cross_.middleCols<6>(at) * move.transpose();
    out.push_back(rows * state_ * rows.transpose() + move * own_.block<6, 6>(at, at) * move.transpose() - mixed -
                  mixed.transpose());
  }
  return out;
}

void AbsoluteCovariance::add_surprise(const PoseVector& step, const LioState& state, std::uint32_t last_epoch) {
  const LioVector error = state_error(step);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxDof, 1> of_map(dof());
  of_map.setZero();
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].last_epoch > last_epoch)
      of_map.segment<6>(column(i)) =
          shift(parts_[i].reference - state.nav.T_world_imu.translation) * to_world(state) * step;
  const double lacking = surprise(step, state_.topLeftCorner<6, 6>());
  state_ += lacking * error * error.transpose();
  cross_ += lacking * error * of_map.transpose();
  own_ += lacking * of_map * of_map.transpose();
}

void AbsoluteCovariance::transform(const LioMatrix& T) {
  state_ = (T * state_ * T.transpose()).eval();
  cross_ = (T * cross_).eval();
}

void AbsoluteCovariance::move(const LioMatrix& T) {
  state_ = transported(T, state_);
  transport_rows(T, cross_);
}

void AbsoluteCovariance::update(const UsedMeasurement& used, bool estimate_extrinsics) {
  cross_.leftCols<6>() *= used.view_kept;
  own_.topRows<6>() *= used.view_kept;
  own_.leftCols<6>() *= used.view_kept;
  own_.topLeftCorner<6, 6>() += (1.0 - used.view_kept * used.view_kept) * used.view_noise;

  // The weighted gradient is A_x x + A_m m + noise in the errors of state and map.
  PoseMatrix information = PoseMatrix::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxDof> of_map(6, dof());
  const PoseMatrix from_world = to_world(used.state).transpose();
  for (std::size_t i = 0; i < used.parts.size(); ++i) {
    information += used.parts[i];
    if (i < parts_.size())
      of_map.middleCols<6>(column(i)) = -used.support * used.parts[i] * from_world *
                                        shift(used.state.nav.T_world_imu.translation - parts_[i].reference);
  }
  of_map.leftCols<6>() = -used.support * information;
  const PoseMatrix of_scan = used.support * information;
  const StateRows of_state = of_scan * pose_rows(used.state, estimate_extrinsics);
  const PoseMatrix mixed_noise = of_state * used.scan.with_state * of_scan.transpose();
  const PoseMatrix noise = of_scan * used.support.transpose() + of_scan * used.scan.noise * of_scan.transpose() -
                           mixed_noise - mixed_noise.transpose();

  const StateRows of_errors = of_state * state_ + of_map * cross_.transpose();
  const StateRows with_state = of_errors - of_scan * used.scan.with_state.transpose();
  const Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxDof> with_map = of_state * cross_ + of_map * own_;
  const PoseMatrix covariance = of_errors * of_state.transpose() + with_map * of_map.transpose() + noise;
  const LioMatrix mixed = used.gain * with_state;
  const LioMatrix updated = state_ - mixed - mixed.transpose() + used.gain * covariance * used.gain.transpose();
  state_ = 0.5 * (updated + updated.transpose());
  cross_ -= used.gain * with_map;
}

std::uint32_t AbsoluteCovariance::remember(const LioState& state, bool estimate_extrinsics) {
  if (parts_.size() == kMaxParts) {
    std::size_t closest = 0;
    for (std::size_t i = 1; i + 1 < parts_.size(); ++i)
      if (difference(i) < difference(closest)) closest = i;
    merge(closest);
  }
  const StateRows rows = to_world(state) * pose_rows(state, estimate_extrinsics);
  const int at = dof();
  own_.conservativeResize(at + 6, at + 6);
  own_.block(at, 0, 6, at) = rows * cross_;
  own_.block(0, at, at, 6) = own_.block(at, 0, 6, at).transpose();
  own_.block<6, 6>(at, at) = rows * state_ * rows.transpose();
  cross_.conservativeResize(kLioDof, at + 6);
  cross_.rightCols<6>() = state_ * rows.transpose();
  parts_.push_back({epochs_, 1.0, state.nav.T_world_imu.translation});
  return epochs_++;
}

double AbsoluteCovariance::difference(std::size_t first) const {
  const int a = column(first), b = column(first + 1);
  const PoseMatrix move = shift(parts_[first + 1].reference - parts_[first].reference);
  const PoseMatrix mixed = move * own_.block<6, 6>(a, b);
  const PoseMatrix apart =
      own_.block<6, 6>(b, b) + move * own_.block<6, 6>(a, a) * move.transpose() - mixed - mixed.transpose();
  return kPoseLever * kPoseLever * apart.diagonal().head<3>().sum() + apart.diagonal().tail<3>().sum();
}

/// The mean error of the two, about a point between them.
void AbsoluteCovariance::merge(std::size_t first) {
  Part& a = parts_[first];
  const Part& b = parts_[first + 1];
  const double share = b.epochs / (a.epochs + b.epochs);
  const Eigen::Vector3d reference = a.reference + share * (b.reference - a.reference);
  const int old = dof(), at = column(first), rest = old - at - 12;
  Own blend = Own::Zero(old - 6, old);
  blend.topLeftCorner(at, at).setIdentity();
  blend.block<6, 6>(at, at) = (1.0 - share) * shift(reference - a.reference);
  blend.block<6, 6>(at, at + 6) = share * shift(reference - b.reference);
  blend.bottomRightCorner(rest, rest).setIdentity();
  own_ = (blend * own_ * blend.transpose()).eval();
  cross_ = (cross_ * blend.transpose()).eval();
  a.reference = reference;
  a.epochs += b.epochs;
  a.last_epoch = b.last_epoch;
  parts_.erase(parts_.begin() + static_cast<std::ptrdiff_t>(first) + 1);
}

}  // namespace allan_lio
