// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/consistency.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/imu/observable_error.h"
#include "allan_lio/io/number_text.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kRelativeDistance = 10.0;  // [m]

/// The truth at a scan, in the estimate's world.
struct TruthSample {
  RigidTransform pose;
  Eigen::Vector3d velocity;
  std::optional<Eigen::Vector3d> gyro_bias, accel_bias;
  double path = 0.0;  ///< travelled so far [m]
};

/// The two truth states around a stamp and the share of the later; false outside the record.
bool bracket(const std::vector<TruthState>& truth, TimeNs stamp, std::size_t* after, double* share) {
  const auto found = std::lower_bound(truth.begin(), truth.end(), stamp,
                                      [](const TruthState& state, TimeNs t) { return state.stamp < t; });
  if (found == truth.end() || (found == truth.begin() && found->stamp != stamp)) return false;
  *after = std::max<std::size_t>(1, static_cast<std::size_t>(found - truth.begin()));
  if (*after >= truth.size()) return false;
  const TruthState &a = truth[*after - 1], &b = truth[*after];
  *share = seconds_between(a.stamp, stamp) / seconds_between(a.stamp, b.stamp);
  return true;
}

/// Velocities at the middles between neighbouring poses.
std::vector<TruthState> differentiated(const Trajectory& truth, double max_gap) {
  std::vector<TruthState> states;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const StampedPose &a = truth[i - 1], &b = truth[i];
    const double dt = seconds_between(a.stamp, b.stamp);
    if (dt > max_gap) continue;
    TruthState state;
    state.stamp = a.stamp + (b.stamp - a.stamp) / 2;
    state.velocity_world = (b.pose.translation - a.pose.translation) / dt;
    states.push_back(state);
  }
  return states;
}

Eigen::Matrix<double, 3, 2> perpendicular(const Eigen::Vector3d& axis) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = axis.unitOrthogonal();
  basis.col(1) = axis.cross(basis.col(0));
  return basis;
}

template <int N>
double nees_of(const Eigen::Matrix<double, N, 1>& error, const Eigen::Matrix<double, N, N>& covariance) {
  const Eigen::LLT<Eigen::Matrix<double, N, N>> llt(covariance);
  // A block that is known exactly, as the pose is at the start, cannot be judged.
  if (llt.info() != Eigen::Success) return kNaN;
  return error.dot(llt.solve(error));
}

class SeriesMaker {
 public:
  SeriesMaker(const Trajectory& truth, const std::vector<TruthState>& truth_states, const StateRecord& states,
              const ConsistencyOptions& options)
      : options_(options), has_innovation_(states.has_innovation) {
    match(truth, states);
    align(truth_states.empty() ? differentiated(truth, options.max_gap) : truth_states, !truth_states.empty());
  }

  ConsistencySeries make() {
    ConsistencySeries series;
    std::size_t ahead = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      series.push_back(judge(i));
      while (ahead < rows_.size() && truth_[ahead].path - truth_[i].path < kRelativeDistance) ++ahead;
      if (ahead < rows_.size()) judge_relative(i, ahead, series.back());
    }
    return series;
  }

 private:
  void match(const Trajectory& truth, const StateRecord& states) {
    Trajectory estimate;
    for (const StateRow& row : states.rows) estimate.push_back({row.nav.stamp, row.nav.T_world_imu});
    matched_ = evaluate_trajectory(truth, estimate, Alignment::kNone, options_.max_gap).errors;
    std::size_t at = 0;
    for (const PoseError& pose : matched_) {
      while (states.rows[at].nav.stamp != pose.stamp) ++at;
      rows_.push_back(states.rows[at]);
    }
  }

  Trajectory references() const {
    Trajectory poses;
    for (const PoseError& pose : matched_) poses.push_back({pose.stamp, pose.reference});
    return poses;
  }

  void align(const std::vector<TruthState>& states, bool biases_known) {
    // Takes the truth's world to the estimate's.
    const RigidTransform T = rows_.front().nav.T_world_imu * matched_.front().reference.inverse();
    turn_ = T.rotation;
    const AxisChoice& axis = options_.axis;
    axis_ = turn_ * (axis.kind == AxisKind::kGiven ? axis.given.normalized() : main_axis(references()));
    double path = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      TruthSample sample;
      sample.pose = T * matched_[i].reference;
      if (i > 0) path += (sample.pose.translation - truth_.back().pose.translation).norm();
      sample.path = path;
      sample.velocity.setConstant(kNaN);
      std::size_t after = 0;
      double share = 0.0;
      if (bracket(states, rows_[i].nav.stamp, &after, &share)) {
        const TruthState &a = states[after - 1], &b = states[after];
        const auto mix = [share](const Eigen::Vector3d& x, const Eigen::Vector3d& y) -> Eigen::Vector3d {
          return (1.0 - share) * x + share * y;
        };
        sample.velocity = turn_ * mix(a.velocity_world, b.velocity_world);
        if (biases_known) {
          sample.gyro_bias = mix(a.gyro_bias, b.gyro_bias);
          sample.accel_bias = mix(a.accel_bias, b.accel_bias);
        }
      }
      truth_.push_back(sample);
    }
  }

  /// In the estimate's world.
  Eigen::Vector3d axis_at(std::size_t i) {
    if (options_.axis.kind == AxisKind::kMotion && truth_[i].velocity.norm() > kMovingSpeed)
      axis_ = truth_[i].velocity.normalized();
    if (options_.axis.kind == AxisKind::kWeakest) {
      const Eigen::Vector3d weakest =
          Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rows_[i].cov_position).eigenvectors().col(2);
      axis_ = weakest.dot(axis_) < 0.0 ? Eigen::Vector3d(-weakest) : weakest;  // so that the error's sign holds
    }
    return axis_;
  }

  ConsistencySample judge(std::size_t i) {
    const StateRow& row = rows_[i];
    const TruthSample& truth = truth_[i];
    ConsistencySample s;
    s.stamp = row.nav.stamp;
    s.support = row.weakest_support;
    s.dof = {2, 3, 3, 3, 1, 2, 3, 3, 6};
    s.nees.fill(kNaN);
    const auto put = [&s](NeesBlock block, double nees) { s.nees[static_cast<std::size_t>(block)] = nees; };

    NavState true_nav;
    true_nav.T_world_imu = truth.pose;
    true_nav.velocity_world = truth.velocity;
    true_nav.gravity_world = turn_ * Eigen::Vector3d(0.0, 0.0, -1.0);
    s.tilt = tilt_error(row.nav, true_nav);
    s.sigma_tilt = row.cov_tilt.diagonal().cwiseMax(0.0).cwiseSqrt();
    put(NeesBlock::kTilt, nees_of<2>(s.tilt, row.cov_tilt));
    const auto vector_block = [&](NeesBlock block, const Eigen::Vector3d& error, const Eigen::Matrix3d& covariance,
                                  Eigen::Vector3d& kept, Eigen::Vector3d& sigma) {
      kept = error;
      sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
      put(block, nees_of<3>(error, covariance));
    };
    const Eigen::Vector3d unknown = Eigen::Vector3d::Constant(kNaN);
    vector_block(NeesBlock::kVelocity, imu_velocity_error(row.nav, true_nav), row.cov_imu_velocity, s.velocity,
                 s.sigma_velocity);
    vector_block(NeesBlock::kGyroBias, truth.gyro_bias.value_or(unknown) - row.nav.gyro_bias, row.cov_gyro_bias,
                 s.gyro_bias, s.sigma_gyro_bias);
    vector_block(NeesBlock::kAccelBias, truth.accel_bias.value_or(unknown) - row.nav.accel_bias, row.cov_accel_bias,
                 s.accel_bias, s.sigma_accel_bias);
    judge_position(i, s, put);
    s.innovation.setConstant(kNaN);
    if (has_innovation_) {
      s.innovation = row.innovation;
      s.dof[static_cast<std::size_t>(NeesBlock::kInnovation)] = row.nis_dof;
      put(NeesBlock::kInnovation, row.nis_dof > 0.0 ? row.nis : kNaN);
    }
    return s;
  }

  template <typename Put>
  void judge_position(std::size_t i, ConsistencySample& s, const Put& put) {
    const Eigen::Vector3d axis = axis_at(i);
    const Eigen::Matrix3d& covariance = rows_[i].cov_position;
    const Eigen::Vector3d error = truth_[i].pose.translation - rows_[i].nav.T_world_imu.translation;
    s.along = error.dot(axis);
    const double variance = std::max(0.0, axis.dot(covariance * axis));
    s.sigma_along = std::sqrt(variance);
    put(NeesBlock::kAlong, variance > 0.0 ? s.along * s.along / variance : kNaN);
    const Eigen::Matrix<double, 3, 2> basis = perpendicular(axis);
    const Eigen::Matrix2d across = basis.transpose() * covariance * basis;
    s.across = basis.transpose() * error;
    s.sigma_across = across.diagonal().cwiseMax(0.0).cwiseSqrt();
    put(NeesBlock::kAcross, nees_of<2>(s.across, across));
  }

  void judge_relative(std::size_t i, std::size_t j, ConsistencySample& s) const {
    const RigidTransform estimate = rows_[i].nav.T_world_imu.inverse() * rows_[j].nav.T_world_imu;
    const RigidTransform truth = truth_[i].pose.inverse() * truth_[j].pose;
    const Eigen::Matrix3d back = rows_[i].nav.T_world_imu.rotation.conjugate().toRotationMatrix();
    const Eigen::Matrix3d lever = skew(estimate.translation);
    const Eigen::Matrix3d position = back * (rows_[i].cov_position + rows_[j].cov_position) * back.transpose() +
                                     lever * rows_[i].cov_theta * lever.transpose();
    s.nees[static_cast<std::size_t>(NeesBlock::kRelativePosition)] =
        nees_of<3>(truth.translation - estimate.translation, position);
    const Eigen::Matrix3d turned = estimate.rotation.conjugate().toRotationMatrix();
    const Eigen::Matrix3d rotation = rows_[j].cov_theta + turned * rows_[i].cov_theta * turned.transpose();
    s.nees[static_cast<std::size_t>(NeesBlock::kRelativeRotation)] =
        nees_of<3>(log_so3(estimate.rotation.conjugate() * truth.rotation), rotation);
  }

  ConsistencyOptions options_;
  bool has_innovation_;
  std::vector<PoseError> matched_;
  std::vector<StateRow> rows_;
  std::vector<TruthSample> truth_;
  Eigen::Quaterniond turn_ = Eigen::Quaterniond::Identity();
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitX();
};

}  // namespace

const char* nees_block_name(NeesBlock block) {
  constexpr std::array<const char*, kNeesBlocks> kNames = {
      "tilt",   "velocity",          "gyro_bias",         "accel_bias", "along",
      "across", "relative_position", "relative_rotation", "innovation"};
  return kNames[static_cast<std::size_t>(block)];
}

Eigen::Vector3d main_axis(const Trajectory& poses) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const StampedPose& pose : poses) mean += pose.pose.translation.head<2>() / static_cast<double>(poses.size());
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const StampedPose& pose : poses) {
    const Eigen::Vector2d d = pose.pose.translation.head<2>() - mean;
    spread += d * d.transpose();
  }
  const Eigen::Vector2d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvectors().col(1);
  return {axis.x(), axis.y(), 0.0};
}

AxisChoice parse_axis(const std::string& text) {
  if (text == "path") return {AxisKind::kPath, {}};
  if (text == "motion") return {AxisKind::kMotion, {}};
  if (text == "weakest") return {AxisKind::kWeakest, {}};
  AxisChoice choice{AxisKind::kGiven, Eigen::Vector3d::Zero()};
  std::istringstream in(text);
  int entries = 0;
  bool valid = true;
  for (std::string word; std::getline(in, word, ','); ++entries)
    valid = valid && entries < 3 && parse_number(word, &choice.given[entries]);
  if (!valid || entries != 3 || !(choice.given.norm() > 0.0))
    throw std::invalid_argument("the axis '" + text +
                                "' is not path, motion, weakest or a direction of three numbers such as 1,0,0");
  return choice;
}

ConsistencySeries consistency_series(const Trajectory& truth, const std::vector<TruthState>& truth_states,
                                     const StateRecord& states, const ConsistencyOptions& options) {
  return SeriesMaker(truth, truth_states, states, options).make();
}

}  // namespace allan_lio
