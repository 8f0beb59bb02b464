// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_impl.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "allan_lio/imu/interval_noise.h"
#include "allan_lio/lidar/keep_evenly.h"
#include "allan_lio/lio/bias_mean.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr int kLostAfter = 10;  // scans in a row without a match

std::unique_ptr<VoxelMap> make_map(const LioConfig& config) {
  // k_r is a matter of the residuals: raised threefold it would make every wall too thick for a plane.
  const VoxelMapOptions options{config.map.voxel_size, config.lidar.range_noise, config.map.radius, config.map.max_mb};
  return config.map.structure == MapStructure::kPlanes ? make_plane_voxel_map(options) : make_point_voxel_map(options);
}

}  // namespace

Odometry::Impl::Impl(const LioConfig& config)
    : config_(config),
      noise_(make_imu_noise(config.imu.spec, config.imu.scale, config.imu.bias_model)),
      synchronizer_(counters_),
      map_(make_map(config)),
      pool_(config.threads),
      residuals_(pool_) {
  state_.T_imu_lidar = config.T_imu_lidar;
  start_.spec = config.imu.spec;
  if (config.imu.accel_unit == AccelUnit::kG) synchronizer_.set_accel_scale(config.imu.gravity);
}

void Odometry::Impl::reconfigure(const LioConfig& config) {
  config_ = config;
  noise_ = make_imu_noise(config_.imu.spec, config_.imu.scale, config_.imu.bias_model);
}

ImuNoise Odometry::Impl::noise_between(const ImuSample& from, const ImuSample& to) {
  const ImuRange range{config_.imu.gyro_range, config_.imu.accel_range};
  if (is_saturated(range, from, to)) ++counters_.imu_saturated;
  const double spacing = synchronizer_.imu().spacing_at(from.stamp + (to.stamp - from.stamp) / 2);
  return allan_lio::noise_between(noise_, range, from, to, spacing);
}

void Odometry::Impl::propagate_covariance(const NavMatrix& transition, const NavMatrix& noise) {
  LioMatrix phi = LioMatrix::Identity(), q = LioMatrix::Zero();
  phi.topLeftCorner<kInertialDof, kInertialDof>() = with_bias_means(transition);
  q.topLeftCorner<kNavDof, kNavDof>() = noise;
  const LioMatrix carried = phi * belief_.covariance * phi.transpose() + q;
  belief_.covariance = 0.5 * (carried + carried.transpose());
  belief_.view.cross = (phi * belief_.view.cross).eval();
  absolute_.transform(phi);
  absolute_.add(q);
}

std::vector<TrackSegment> Odometry::Impl::propagate_to(TimeNs t) {
  const double gap = synchronizer_.imu().longest_gap(state_.nav.stamp, t);
  std::vector<ImuSample> samples = synchronizer_.imu().between(state_.nav.stamp, t);
  for (ImuSample& sample : samples) sample.accel *= accel_scale_;
  std::vector<TrackSegment> track;
  track.reserve(samples.size());
  NavMatrix transition = NavMatrix::Identity(), noise = NavMatrix::Zero();
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const ImuInterval interval = mean_interval(state_.nav, samples[i], samples[i + 1]);
    track.push_back({state_.nav, interval});
    if (interval.dt > 0) {  // a first scan without duration begins and ends at the state
      const DiscreteModel model =
          discretize(state_.nav, interval, noise_between(samples[i], samples[i + 1]), config_.imu.discretization);
      transition = (model.phi * transition).eval();
      noise = (model.phi * noise * model.phi.transpose() + model.q).eval();
    }
    state_.nav = propagate_mean(state_.nav, interval, noise_);
    state_.nav.stamp = samples[i + 1].stamp;
  }
  propagate_covariance(transition, noise);
  if (gap > kImuGap) ++counters_.imu_gaps;
  gyro_ = samples.back().gyro - state_.nav.gyro_bias;
  synchronizer_.discard_before(t);
  return track;
}

void Odometry::Impl::select_points(const Scan& scan) {
  if (scan.thinned) {
    inserted_.resize(scan.points.size());
    std::iota(inserted_.begin(), inserted_.end(), 0U);
    registered_ = scan.registered;
  } else {
    downsampler_.select(scan.points, nullptr, config_.map.insert_leaf, inserted_);
    downsampler_.select(scan.points, &inserted_, config_.lidar.leaf, registered_);
  }
  const std::size_t all = registered_.size();
  if (config_.lidar.max_registered > 0)
    keep_evenly(scan.points, static_cast<std::size_t>(config_.lidar.max_registered), registered_);
  counters_.points_over_budget += all - registered_.size();
}

Deskewer Odometry::Impl::make_deskewer(const Scan& scan, const std::vector<TrackSegment>& track,
                                       const NavState& reference) const {
  if (!config_.lidar.deskew) return Deskewer(state_.T_imu_lidar);
  return Deskewer(scan, track, reference, state_.T_imu_lidar, noise_);
}

void Odometry::Impl::deskew_points(const Scan& scan) {
  const auto deskew = [&](const std::vector<std::uint32_t>& indices, std::vector<Eigen::Vector3f>& out) {
    out.resize(indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) out[i] = (*deskewer_)(scan.points[indices[i]]);
  };
  deskew(inserted_, inserted_points_);
  deskew(registered_, registered_points_);
}

void Odometry::Impl::insert_scan() {
  const RigidTransform& T_world_imu = state_.nav.T_world_imu;
  const Eigen::Matrix3d rotation = T_world_imu.rotation.toRotationMatrix();
  world_points_.resize(inserted_points_.size());
  for (std::size_t i = 0; i < inserted_points_.size(); ++i)
    world_points_[i] = rotation * inserted_points_[i].cast<double>() + T_world_imu.translation;
  const std::uint32_t epoch = absolute_.remember(state_, config_.estimate_extrinsics);
  map_->insert(world_points_, T_world_imu * state_.T_imu_lidar.translation, epoch);
  inserted_at_ = T_world_imu;
}

void Odometry::Impl::clear_map() {
  map_->clear();
  places_.forget();
}

bool Odometry::Impl::moved_since_insertion() const {
  const RigidTransform motion = inserted_at_.inverse() * state_.nav.T_world_imu;
  return motion.translation.norm() > config_.map.insert_distance ||
         log_so3(motion.rotation).norm() > config_.map.insert_angle;
}

ScanOutcome Odometry::Impl::settle_unmatched() {
  ++unmatched_in_a_row_;
  if (!map_proven_) {  // the first scans may be too thin to make planes; on flat ground it takes motion to fill them
    if (scans_processed_ <= kSettlingScans || moved_since_insertion()) insert_scan();
  } else if (unmatched_in_a_row_ >= kLostAfter) {
    clear_map();
    map_proven_ = false;
    anchor_pose();
    absolute_.forget_map();
    insert_scan();
    unmatched_in_a_row_ = 0;
    return ScanOutcome::kMapRestarted;
  }
  return ScanOutcome::kTooFewMatches;
}

UpdateReport Odometry::Impl::register_scan(const Scan& scan, LioResult& result) {
  ScanConditions conditions{seconds_between(updated_at_, state_.nav.stamp),
                            config_.lidar.deskew ? seconds_between(scan.begin(), scan.end()) : 0.0, noise_.gyro_psd};
  if (config_.update.relocalize && config_.map.structure == MapStructure::kPlanes)
    conditions.place = places_.look(registered_points_, state_, *map_, absolute_, config_.estimate_extrinsics);
  const auto update = [&] {
    return iterated_update(registered_points_, *map_, config_, conditions, residuals_, state_, belief_, absolute_);
  };
  UpdateReport report = update();
  if (conditions.place && !report.applied) {
    conditions.place.reset();
    report = update();
  }
  if (report.relocated) {
    ++counters_.places_found;
    result.relocated = conditions.place->step;
  }
  describe(report, result);
  return report;
}

LioResult Odometry::Impl::begin_result(const Scan& scan) const {
  LioResult result;
  result.scan_begin = scan.begin();
  result.points = static_cast<int>(scan.points.size() + scan.thinned_away);
  result.registered = static_cast<int>(registered_.size());
  return result;
}

void Odometry::Impl::describe(const UpdateReport& report, LioResult& result) {
  result.inliers = report.inliers;
  result.iterations = report.iterations;
  result.residual_rms = report.residual_rms;
  result.localizability = report.localizability;
  result.innovation = report.innovation;
  result.measurement = report.measurement;
}

LioResult Odometry::Impl::finish(ScanOutcome outcome, Scan scan, LioResult result) {
  result.outcome = outcome;
  result.state = state_;
  result.covariance = absolute_.state();
  result.gyro = gyro_;
  if (outcome == ScanOutcome::kTooFewPoints) ++counters_.scans_too_few_points;
  if (outcome == ScanOutcome::kTooFewMatches) ++counters_.scans_too_few_matches;
  if (outcome == ScanOutcome::kMapRestarted) ++counters_.map_restarts;
  if (outcome != ScanOutcome::kTooFewPoints && outcome != ScanOutcome::kTooFewMatches) ++counters_.scans_used;
  ++scans_processed_;
  scan_ = std::move(scan);
  return result;
}

std::vector<WorldPoint> Odometry::Impl::deskewed_points() const {
  std::vector<WorldPoint> out;
  if (!deskewer_) return out;
  out.reserve(scan_.points.size());
  for (const ScanPoint& point : scan_.points) {
    const Eigen::Vector3f p = (state_.nav.T_world_imu * (*deskewer_)(point).cast<double>()).cast<float>();
    out.push_back({p.x(), p.y(), p.z(), point.intensity});
  }
  return out;
}

std::vector<WorldPoint> Odometry::Impl::map_points() const {
  std::vector<WorldPoint> out;
  for (const Eigen::Vector3d& p : map_->points())
    out.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()), 0.0F});
  return out;
}

}  // namespace allan_lio
