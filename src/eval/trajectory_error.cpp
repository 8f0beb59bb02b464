// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/trajectory_error.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr TimeNs kRelativeTime = kNsPerSecond;        // [ns]
constexpr TimeNs kTimeTolerance = kNsPerSecond / 20;  // a pair must be less than this off kRelativeTime [ns]
constexpr double kRelativeDistance = 10.0;            // [m]
constexpr double kCollinear = 1e-9;                   // second over first singular value below which rotation is free

double rotation_angle(const RigidTransform& a, const RigidTransform& b) {
  return log_so3(a.rotation.conjugate() * b.rotation).norm();
}

/// The reference at `t`; false outside its span or inside a gap.
bool interpolate(const Trajectory& reference, TimeNs t, double max_gap, RigidTransform* pose) {
  const auto after = std::lower_bound(reference.begin(), reference.end(), t,
                                      [](const StampedPose& p, TimeNs stamp) { return p.stamp < stamp; });
  if (after == reference.end()) return false;
  if (after->stamp == t) {
    *pose = after->pose;
    return true;
  }
  if (after == reference.begin()) return false;
  const auto before = std::prev(after);
  const double gap = seconds_between(before->stamp, after->stamp);
  if (gap > max_gap) return false;
  const double s = seconds_between(before->stamp, t) / gap;
  pose->translation = (1.0 - s) * before->pose.translation + s * after->pose.translation;
  pose->rotation = before->pose.rotation.slerp(s, after->pose.rotation).normalized();
  return true;
}

std::string span(const Trajectory& trajectory) {
  if (trajectory.empty()) return "no";
  return format_seconds(trajectory.front().stamp) + " to " + format_seconds(trajectory.back().stamp);
}

/// Matched pairs, the estimate not yet aligned.
std::vector<PoseError> associate(const Trajectory& reference, const Trajectory& estimate, double max_gap) {
  std::vector<PoseError> pairs;
  pairs.reserve(estimate.size());
  for (const StampedPose& pose : estimate) {
    PoseError pair;
    if (!interpolate(reference, pose.stamp, max_gap, &pair.reference)) continue;
    pair.stamp = pose.stamp;
    pair.estimate = pose.pose;
    pairs.push_back(pair);
  }
  return pairs;
}

/// Rotation that takes centred estimate positions to centred reference positions, from
/// correlation = sum (reference)(estimate)^T.
Eigen::Quaterniond fit_rotation(const Eigen::Matrix3d& correlation) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[1] > kCollinear * svd.singularValues()[0]))
    throw std::runtime_error(
        "the matched positions lie on a line or a point, so they do not determine the se3 alignment; "
        "align by yaw or by start instead");
  Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if (rotation.determinant() < 0) {
    Eigen::Matrix3d u = svd.matrixU();
    u.col(2) = -u.col(2);
    rotation = u * svd.matrixV().transpose();
  }
  return Eigen::Quaterniond(rotation).normalized();
}

/// The heading that maximises sum reference . Rz(yaw) estimate.
Eigen::Quaterniond fit_yaw(const Eigen::Matrix3d& correlation) {
  const double yaw = std::atan2(correlation(1, 0) - correlation(0, 1), correlation(0, 0) + correlation(1, 1));
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

RigidTransform fit_positions(const std::vector<PoseError>& pairs, Alignment alignment) {
  Eigen::Vector3d reference_mean = Eigen::Vector3d::Zero(), estimate_mean = Eigen::Vector3d::Zero();
  for (const PoseError& pair : pairs) {
    reference_mean += pair.reference.translation;
    estimate_mean += pair.estimate.translation;
  }
  reference_mean /= static_cast<double>(pairs.size());
  estimate_mean /= static_cast<double>(pairs.size());
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  for (const PoseError& pair : pairs)
    correlation +=
        (pair.reference.translation - reference_mean) * (pair.estimate.translation - estimate_mean).transpose();
  RigidTransform result;
  result.rotation = alignment == Alignment::kSe3 ? fit_rotation(correlation) : fit_yaw(correlation);
  result.translation = reference_mean - result.rotation * estimate_mean;
  return result;
}

RigidTransform align(const std::vector<PoseError>& pairs, Alignment alignment) {
  switch (alignment) {
    case Alignment::kNone:
      return {};
    case Alignment::kStart:
      return pairs.front().reference * pairs.front().estimate.inverse();
    default:
      return fit_positions(pairs, alignment);
  }
}

ErrorStatistics statistics(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  ErrorStatistics result;
  double squares = 0.0, sum = 0.0;
  for (const double value : values) {
    squares += value * value;
    sum += value;
  }
  result.rmse = std::sqrt(squares / static_cast<double>(n));
  result.mean = sum / static_cast<double>(n);
  result.median = 0.5 * (values[(n - 1) / 2] + values[n / 2]);
  result.max = values.back();
  return result;
}

/// Path travelled by the reference up to each matched pose [m].
std::vector<double> travelled(const std::vector<PoseError>& pairs) {
  std::vector<double> path(pairs.size(), 0.0);
  for (std::size_t i = 1; i < pairs.size(); ++i)
    path[i] = path[i - 1] + (pairs[i].reference.translation - pairs[i - 1].reference.translation).norm();
  return path;
}

/// E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j), Q the reference, P the estimate.
RigidTransform relative_error(const PoseError& i, const PoseError& j) {
  const RigidTransform reference = i.reference.inverse() * j.reference;
  return reference.inverse() * (i.estimate.inverse() * j.estimate);
}

/// Sums of squares over pairs of poses.
class RelativeSum {
 public:
  void add(const PoseError& i, const PoseError& j, double path) {
    const RigidTransform error = relative_error(i, j);
    ++pairs_;
    translation_ += error.translation.squaredNorm();
    rotation_ += std::pow(rotation_angle({}, error), 2);
    path_ += path * path;
  }

  RelativeError result() const {
    if (pairs_ == 0) return {};
    const double n = static_cast<double>(pairs_);
    const double ratio = path_ > 0.0 ? std::sqrt(translation_ / path_) : std::numeric_limits<double>::quiet_NaN();
    return {pairs_, std::sqrt(translation_ / n), 100.0 * ratio, std::sqrt(rotation_ / n)};
  }

 private:
  std::size_t pairs_ = 0;
  double translation_ = 0.0, rotation_ = 0.0, path_ = 0.0;
};

/// Every pose with the one whose stamp is nearest to 1 s later.
RelativeError error_over_time(const std::vector<PoseError>& pairs, const std::vector<double>& path) {
  RelativeSum sum;
  std::size_t j = 0;
  const auto off = [&pairs](std::size_t from, std::size_t to) {
    return std::abs(pairs[to].stamp - pairs[from].stamp - kRelativeTime);
  };
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    j = std::max(j, i);
    while (j + 1 < pairs.size() && off(i, j + 1) <= off(i, j)) ++j;
    if (off(i, j) < kTimeTolerance) sum.add(pairs[i], pairs[j], path[j] - path[i]);
  }
  return sum.result();
}

/// Every pose with the first one that lies 10 m of path or more ahead.
RelativeError error_over_distance(const std::vector<PoseError>& pairs, const std::vector<double>& path) {
  RelativeSum sum;
  std::size_t j = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    while (j < pairs.size() && path[j] - path[i] < kRelativeDistance) ++j;
    if (j == pairs.size()) break;
    sum.add(pairs[i], pairs[j], path[j] - path[i]);
  }
  return sum.result();
}

}  // namespace

TrajectoryError evaluate_trajectory(const Trajectory& reference, const Trajectory& estimate, Alignment alignment,
                                    double max_gap) {
  TrajectoryError result;
  result.errors = associate(reference, estimate, max_gap);
  std::vector<PoseError>& pairs = result.errors;
  if (pairs.empty())
    throw std::runtime_error("no pose of the estimate can be matched: the reference spans " + span(reference) +
                             " s, the estimate " + span(estimate) + " s");
  result.alignment = alignment;
  result.matched = pairs.size();
  result.unmatched = estimate.size() - pairs.size();
  result.duration = seconds_between(pairs.front().stamp, pairs.back().stamp);
  result.T_reference_estimate = align(pairs, alignment);

  std::vector<double> translations, rotations;
  for (PoseError& pair : pairs) {
    pair.estimate = result.T_reference_estimate * pair.estimate;
    pair.translation = pair.estimate.translation - pair.reference.translation;
    pair.rotation = rotation_angle(pair.reference, pair.estimate);
    translations.push_back(pair.translation.norm());
    rotations.push_back(pair.rotation);
  }
  result.translation = statistics(translations);
  result.rotation = statistics(rotations);

  const std::vector<double> path = travelled(pairs);
  result.path_length = path.back();
  result.over_1s = error_over_time(pairs, path);
  result.over_10m = error_over_distance(pairs, path);
  result.end_drift = relative_error(pairs.front(), pairs.back()).translation.norm();
  result.end_drift_percent =
      path.back() > 0.0 ? 100.0 * result.end_drift / path.back() : std::numeric_limits<double>::quiet_NaN();
  return result;
}

}  // namespace allan_lio
