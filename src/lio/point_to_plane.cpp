// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/point_to_plane.h"

#include <algorithm>
#include <cmath>

#include "allan_lio/lio/drift.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

/// Derivative of n^T (R q + p) along `direction` = n: [q x R^T n; n].
PoseVector pose_row(const Eigen::Vector3d& q, const Eigen::Matrix3d& back, const Eigen::Vector3d& direction) {
  PoseVector row;
  row << q.cross(back * direction), direction;
  return row;
}

/// Everything about one scan that a residual needs.
struct Context {
  Eigen::Matrix3d rotation, back;
  Eigen::Vector3d translation;
  const ScanUncertainty& uncertainty;
  const ResidualOptions& options;
  ResidualNoise noise;

  Context(const LioState& state, const ScanUncertainty& uncertainty, const ResidualOptions& residual_options)
      : rotation(state.nav.T_world_imu.rotation.toRotationMatrix()),
        back(rotation.transpose()),
        translation(state.nav.T_world_imu.translation),
        uncertainty(uncertainty),
        options(residual_options),
        noise(residual_options, uncertainty) {}
};

/// Adds to the sums, but the information to its part. Returns the weight, 0 for an outlier.
double add_residual(const Context& context, const Eigen::Vector3d& q, const Plane& plane, double sharing,
                    std::size_t part, NormalEquations& sum, PoseMatrix& information) {
  const ResidualOptions& options = context.options;
  const Eigen::Vector3d point = context.rotation * q + context.translation;
  const double z = plane.distance(point);
  const PoseVector row = pose_row(q, context.back, plane.normal);
  const PoseVector lean_1 = pose_row(q, context.back, plane.lean_1);
  const PoseVector lean_2 = pose_row(q, context.back, plane.lean_2);
  ++sum.matched;
  const PoseMatrix* against_part = part < context.uncertainty.parts.size() ? &context.uncertainty.parts[part] : nullptr;
  const ResidualVariance noise =
      context.noise.of(plane, q, context.back * plane.normal, point, lean_1, lean_2, against_part);
  const double single = noise.own + noise.plane;
  double pose_variance = row.dot(context.uncertainty.pose * row);
  if (against_part) pose_variance = std::max(pose_variance, row.dot(*against_part * row));
  if (z * z > options.gate * options.gate * (single + pose_variance)) return 0.0;

  const double variance = single + (sharing - 1.0) * noise.center + sharing * noise.lean;
  const double deviations = std::abs(z) / std::sqrt(single);
  const double robust = deviations <= options.robust_scale ? 1.0 : options.robust_scale / deviations;
  const double weight = robust / variance;
  const PoseVector weighed = weight * row;
  const PoseMatrix product = weighed * row.transpose();
  information += product;
  sum.gradient.head<6>() -= z * weighed;
  sum.plane_scatter += (weight * sharing * (noise.plane + noise.lean / ResidualNoise::kLooks)) * product;
  sum.feigned.noalias() += weight * lean_1 * lean_1.transpose();
  sum.feigned.noalias() += weight * lean_2 * lean_2.transpose();
  sum.squared_range += q.squaredNorm();
  sum.squared_distance += z * z;
  ++sum.inliers;
  return weight;
}

/// Number of the part that an epoch falls into.
std::size_t part_of(std::uint32_t epoch, const std::vector<std::uint32_t>& last_epochs) {
  std::size_t part = 0;
  while (part + 1 < last_epochs.size() && epoch > last_epochs[part]) ++part;
  return part;
}

}  // namespace

PoseRows lidar_pose_rows(const LioState& state, bool estimate_extrinsics) {
  PoseRows rows = PoseRows::Identity();
  if (!estimate_extrinsics) return rows;
  const Eigen::Matrix3d R_world_imu = state.nav.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix3d R_imu_lidar = state.T_imu_lidar.rotation.toRotationMatrix();
  rows.block<3, 3>(0, 6) = R_imu_lidar;
  rows.block<3, 3>(3, 6) = R_world_imu * skew(state.T_imu_lidar.translation) * R_imu_lidar;
  rows.block<3, 3>(3, 9) = R_world_imu;
  return rows;
}

void NormalEquations::spread(const PoseRows& rows) {
  const PoseMatrix pose_information = information.topLeftCorner<6, 6>();
  const PoseVector pose_gradient = gradient.head<6>();
  information = rows.transpose() * pose_information * rows;
  gradient = rows.transpose() * pose_gradient;
}

void NormalEquations::add(const NormalEquations& other) {
  information += other.information;
  gradient += other.gradient;
  feigned += other.feigned;
  plane_scatter += other.plane_scatter;
  squared_range += other.squared_range;
  squared_distance += other.squared_distance;
  matched += other.matched;
  inliers += other.inliers;
}

void PointToPlane::match(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state, const VoxelMap& map,
                         const OldPlanes& old_planes) {
  planes_.resize(points_imu.size());
  scratch_.resize(points_imu.size());
  const Eigen::Matrix3d rotation = state.nav.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Vector3d& translation = state.nav.T_world_imu.translation;
  pool_.run(points_imu.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3d point = rotation * points_imu[i].cast<double>() + translation;
      planes_[i] = map.find(point, scratch_[i]);
      if (old_planes.reach == 0.0 || (planes_[i] && planes_[i]->epoch <= old_planes.last_epoch)) continue;
      if (const Plane* old = map.find_old(point, translation, old_planes)) planes_[i] = old;
    }
  });
}

void PointToPlane::count_groups() {
  for (const Plane* plane : planes_)
    if (plane && plane->group != Plane::kNoGroup && plane->group >= shared_.size()) shared_.resize(plane->group + 1);
  for (const Plane* plane : planes_)
    if (plane && plane->group != Plane::kNoGroup) shared_[plane->group] = 0;
  for (const Plane* plane : planes_)
    if (plane && plane->group != Plane::kNoGroup) ++shared_[plane->group];
}

NormalEquations PointToPlane::linearize(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                                        const ScanUncertainty& uncertainty, const VoxelMap& map,
                                        const ResidualOptions& options, const std::vector<std::uint32_t>& last_epochs) {
  match(points_imu, state, map, old_planes(uncertainty.parts, last_epochs, kDriftedOff));
  count_groups();
  const Context context(state, uncertainty, options);
  const std::size_t blocks = TaskPool::blocks(points_imu.size()), parts = std::max<std::size_t>(1, last_epochs.size());
  weights_.assign(points_imu.size(), 0.0);
  blocks_.assign(blocks, NormalEquations{});
  block_parts_.assign(blocks * parts, PoseMatrix::Zero());
  pool_.run(points_imu.size(), [&](std::size_t block, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!planes_[i]) continue;
      const std::size_t part = part_of(planes_[i]->epoch, last_epochs);
      weights_[i] = add_residual(context, points_imu[i].cast<double>(), *planes_[i], sharing(i), part, blocks_[block],
                                 block_parts_[block * parts + part]);
    }
  });
  NormalEquations total;
  for (const NormalEquations& block : blocks_) total.add(block);
  parts_.assign(parts, PoseMatrix::Zero());
  for (std::size_t i = 0; i < block_parts_.size(); ++i) parts_[i % parts] += block_parts_[i];
  for (const PoseMatrix& part : parts_) total.information.topLeftCorner<6, 6>() += part;
  total.spread(lidar_pose_rows(state, options.estimate_extrinsics));
  return total;
}

PoseVector PointToPlane::squares_along(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                                       const Localizability& found) {
  const PoseMatrix directions = unscaled_directions(found);
  const Eigen::Matrix3d back = state.nav.T_world_imu.rotation.toRotationMatrix().transpose();
  PoseVector out = PoseVector::Zero();
  columns_.begin(points_imu.size());
  for (std::size_t i = 0; i < points_imu.size(); ++i) {
    if (weights_[i] == 0.0) continue;
    // The m points on a plane add about the same, so the square of their sum is m times the sum of their squares.
    const PoseVector along = directions.transpose() * pose_row(points_imu[i].cast<double>(), back, planes_[i]->normal);
    const PoseVector information = weights_[i] * along.cwiseAbs2();
    out += sharing(i) * information.cwiseAbs2();
    columns_.add(planes_[i]->center, information);
  }
  const PoseVector of_columns = columns_.squares();
  const PoseVector turns = found.directions.topRows<3>().transpose() * back.col(2);
  for (int k = 0; k < 6; ++k)
    if (turns[k] * turns[k] > 0.5) out[k] = of_columns[k];
  return out;
}

PoseMatrix PointToPlane::coupling_noise(const std::vector<Eigen::Vector3f>& points_imu, const LioState& state,
                                        const PoseVector& direction) const {
  const Eigen::Matrix3d back = state.nav.T_world_imu.rotation.toRotationMatrix().transpose();
  PoseMatrix out = PoseMatrix::Zero();
  for (std::size_t i = 0; i < points_imu.size(); ++i) {
    if (weights_[i] == 0.0) continue;
    const Eigen::Vector3d q = points_imu[i].cast<double>();
    const double lean_1 = pose_row(q, back, planes_[i]->lean_1).dot(direction);
    const double lean_2 = pose_row(q, back, planes_[i]->lean_2).dot(direction);
    const PoseVector row = pose_row(q, back, planes_[i]->normal);
    // The m points on a plane share its lean: their sum's variance is about m times that of m alone.
    const double variance = sharing(i) * weights_[i] * weights_[i] * (lean_1 * lean_1 + lean_2 * lean_2);
    out.noalias() += variance * row * row.transpose();
  }
  return out;
}

}  // namespace allan_lio
