// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry_impl.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "allan_lio/imu/static_init.h"
#include "allan_lio/math/s2.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr double kCountedGap = 0.1;           // [s] between IMU samples
constexpr int kSettlingScans = 10;            // after which the start counts as settled
constexpr double kSaturatedPart = 0.2;        // 1 sigma of a saturated reading, of the full scale
constexpr double kUnknownRate = 0.5;          // [rad/s] 1 sigma of the rotation rate in a gap that is not bridged

std::unique_ptr<VoxelMap> make_map(const LioConfig& config) {
  const VoxelMapOptions options{config.map.voxel_size, config.lidar.k_r * config.lidar.range_noise, config.map.radius,
                                config.map.max_mb};
  return config.map.structure == MapStructure::kPlanes ? make_plane_voxel_map(options)
                                                       : make_point_voxel_map(options);
}

double square(double x) { return x * x; }

}  // namespace

Odometry::Impl::Impl(const LioConfig& config)
    : config_(config),
      noise_(make_imu_noise(config.imu.spec, config.imu.scale, config.imu.bias_model)),
      synchronizer_(counters_),
      map_(make_map(config)),
      pool_(config.threads),
      residuals_(pool_) {
  state_.T_imu_lidar = config.T_imu_lidar;
}

void Odometry::Impl::set_noise_scale(const NoiseScale& scale) {
  config_.imu.scale = scale;
  noise_ = make_imu_noise(config_.imu.spec, scale, config_.imu.bias_model);
}

bool Odometry::Impl::initialize_from_imu() {
  const Scan* first = synchronizer_.front();
  if (!first) {
    if (synchronizer_.ended()) synchronizer_.take();  // settles what waits
    return false;
  }
  const ImuBuffer& imu = synchronizer_.imu();
  const TimeNs start = first->begin();
  const TimeNs from = std::max(imu.oldest(), start - to_ns(config_.init.standstill_time));
  const TimeNs until = from + to_ns(config_.init.standstill_time);
  if (imu.newest() < until && !synchronizer_.ended()) return false;

  std::vector<ImuSample> record = imu.between(from, std::min(until, std::max(imu.newest(), from + 1)));
  const bool in_g = config_.imu.accel_unit == AccelUnit::kG;
  accel_scale_ = config_.imu.accel_unit == AccelUnit::kAuto ? detect_accel_scale(record, config_.imu.gravity)
                                                            : (in_g ? config_.imu.gravity : 1.0);
  for (ImuSample& sample : record) sample.accel *= accel_scale_;
  const InitOptions options{config_.imu.gravity, config_.init.gyro_still, config_.init.accel_still,
                            config_.init.velocity_sigma, config_.init.moving_accel_sigma};
  quiet_start_ = is_still(record, options);
  if (!quiet_start_) {
    const TimeNs short_end = from + to_ns(config_.init.moving_time);
    while (record.size() > 2 && record.back().stamp > short_end) record.pop_back();
  }
  const InitialState initial = initialize(record, quiet_start_, config_.imu.spec, noise_, options);
  state_.nav = initial.state;
  state_.nav.stamp = start;
  covariance_.topLeftCorner<kNavDof, kNavDof>() = initial.covariance;
  if (config_.estimate_extrinsics) {
    covariance_.diagonal().segment<3>(kExtrinsicRotation).setConstant(square(config_.extrinsic_rotation_sigma));
    covariance_.diagonal().segment<3>(kExtrinsicTranslation).setConstant(square(config_.extrinsic_translation_sigma));
  }
  initialized_ = true;
  return true;
}

ImuNoise Odometry::Impl::noise_between(const ImuSample& from, const ImuSample& to) {
  const double dt = seconds_between(from.stamp, to.stamp);
  const bool gyro = std::max(from.gyro.cwiseAbs().maxCoeff(), to.gyro.cwiseAbs().maxCoeff()) >= config_.imu.gyro_range;
  const bool accel =
      std::max(from.accel.cwiseAbs().maxCoeff(), to.accel.cwiseAbs().maxCoeff()) >= config_.imu.accel_range;
  if (!gyro && !accel) return noise_;
  ++counters_.imu_saturated;
  ImuNoise inflated = noise_;
  if (gyro) inflated.gyro_psd.array() += square(kSaturatedPart * config_.imu.gyro_range) * dt;
  if (accel) inflated.accel_psd.array() += square(kSaturatedPart * config_.imu.accel_range) * dt;
  return inflated;
}

void Odometry::Impl::bridge(double gap) {
  auto variance = covariance_.diagonal();
  variance.segment<3>(kVelocity).array() += square(config_.init.velocity_sigma);
  variance.segment<3>(kPosition).array() += square(config_.init.velocity_sigma * gap);
  variance.segment<3>(kTheta).array() += square(std::min(kUnknownRate * gap, 1.0));
}

std::vector<TrackSegment> Odometry::Impl::propagate_to(TimeNs t) {
  std::vector<ImuSample> samples = synchronizer_.imu().between(state_.nav.stamp, t);
  for (ImuSample& sample : samples) sample.accel *= accel_scale_;
  std::vector<TrackSegment> track;
  track.reserve(samples.size());
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const ImuInterval interval = mean_interval(state_.nav, samples[i], samples[i + 1]);
    const DiscreteModel model =
        discretize(state_.nav, interval, noise_between(samples[i], samples[i + 1]), config_.imu.discretization);
    track.push_back({state_.nav, interval});
    state_.nav = propagate_mean(state_.nav, interval, noise_);
    state_.nav.stamp = samples[i + 1].stamp;

    auto nav = covariance_.topLeftCorner<kNavDof, kNavDof>();
    const NavMatrix carried = model.phi * nav * model.phi.transpose() + model.q;
    nav = 0.5 * (carried + carried.transpose());
    if (config_.estimate_extrinsics) {
      covariance_.topRightCorner<kNavDof, 6>() = model.phi * covariance_.topRightCorner<kNavDof, 6>().eval();
      covariance_.bottomLeftCorner<6, kNavDof>() = covariance_.topRightCorner<kNavDof, 6>().transpose();
    }
    if (interval.dt > kCountedGap) ++counters_.imu_gaps;
    if (interval.dt > config_.imu.max_gap) bridge(interval.dt);
  }
  gyro_ = samples.back().gyro - state_.nav.gyro_bias;
  synchronizer_.discard_before(t);
  return track;
}

void Odometry::Impl::select_points(const Scan& scan) {
  downsampler_.select(scan.points, nullptr, config_.map.insert_leaf, inserted_);
  downsampler_.select(scan.points, &inserted_, config_.lidar.leaf, registered_);
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
  map_->insert(world_points_, T_world_imu * state_.T_imu_lidar.translation);
}

void Odometry::Impl::make_first_pose() {
  NavState& nav = state_.nav;
  const Eigen::Vector3d x = nav.T_world_imu.rotation * Eigen::Vector3d::UnitX();
  const double heading = x.head<2>().norm() < 1e-3 ? 0.0 : std::atan2(x.y(), x.x());
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()));
  nav.T_world_imu.rotation = (turn * nav.T_world_imu.rotation).normalized();
  nav.T_world_imu.translation.setZero();
  nav.velocity_world = turn * nav.velocity_world;
  nav.gravity_world = turn * nav.gravity_world;
  first_pose_ = nav.T_world_imu;
  anchor_pose();
}

void Odometry::Impl::anchor_pose() {
  // In the world turned by R_hat R^T the pose is R_hat; to first order v turns by -R dtheta, and so does g.
  const Eigen::Matrix3d rotation = state_.nav.T_world_imu.rotation.toRotationMatrix();
  LioMatrix turn = LioMatrix::Identity();
  turn.block<3, 3>(kVelocity, kTheta) = skew(state_.nav.velocity_world) * rotation;
  turn.block<2, 3>(kGravity, kTheta) = -s2_basis(state_.nav.gravity_world).transpose() * rotation;
  covariance_ = turn * covariance_ * turn.transpose();
  covariance_.topRows<6>().setZero();
  covariance_.leftCols<6>().setZero();
  if (config_.estimate_extrinsics) anchor_lidar_pose();
}

void Odometry::Impl::anchor_lidar_pose() {
  // The IMU's pose errs by what cancels the extrinsics' error in the LiDAR's pose; v and g turn along.
  const Eigen::Matrix3d rotation = state_.nav.T_world_imu.rotation.toRotationMatrix();
  const Eigen::Matrix<double, 6, 6> pose = -lidar_pose_rows(state_, true).rightCols<6>();
  LioMatrix turn = LioMatrix::Identity();
  turn.block<6, 6>(kTheta, kExtrinsicRotation) = pose;
  turn.block<3, 6>(kVelocity, kExtrinsicRotation) = -skew(state_.nav.velocity_world) * rotation * pose.topRows<3>();
  turn.block<2, 6>(kGravity, kExtrinsicRotation) =
      s2_basis(state_.nav.gravity_world).transpose() * rotation * pose.topRows<3>();
  covariance_ = turn * covariance_ * turn.transpose();
}

void Odometry::Impl::settle_standstill() {
  LioState start = state_;
  start.nav.T_world_imu = first_pose_;
  if (agrees_with_standstill(registered_points_, start, *map_, residual_options(config_), residuals_))
    update_zero_velocity(config_.init.still_velocity_sigma, state_, covariance_);
}

bool Odometry::Impl::is_distorted(const Scan& scan, const Eigen::Vector3d& predicted_velocity) const {
  if (scans_processed_ > kSettlingScans) return false;
  const double smear = (state_.nav.velocity_world - predicted_velocity).norm() * seconds_between(scan.begin(), scan.end());
  return smear > config_.lidar.range_noise;
}

void Odometry::Impl::found_map_again(const Scan& scan, std::vector<TrackSegment> track) {
  // The posterior's velocity and biases, carried back over the scan by the same readings.
  const NavState& now = state_.nav;
  const NavState predicted = propagate_mean(track.back().start, track.back().interval, noise_);
  const Eigen::Vector3d wrong_by = predicted.velocity_world - now.velocity_world;
  for (TrackSegment& segment : track) segment.start.velocity_world -= wrong_by;
  NavState reference = track.front().start;
  for (std::size_t i = 0; i < track.size(); ++i) {
    track[i].start.T_world_imu = reference.T_world_imu;
    reference = propagate_mean(track[i].start, track[i].interval, noise_);
  }
  deskewer_ = make_deskewer(scan, track, reference);
  deskew_points(scan);
  map_->clear();
  anchor_pose();
}

LioResult Odometry::Impl::begin_result(const Scan& scan) const {
  LioResult result;
  result.scan_begin = scan.begin();
  result.points = static_cast<int>(scan.points.size());
  result.registered = static_cast<int>(registered_.size());
  return result;
}

void Odometry::Impl::describe(const UpdateReport& report, LioResult& result) {
  result.inliers = report.inliers;
  result.iterations = report.iterations;
  result.residual_rms = report.residual_rms;
  result.localizability = report.localizability;
}

LioResult Odometry::Impl::finish(ScanOutcome outcome, Scan scan, LioResult result) {
  result.outcome = outcome;
  result.state = state_;
  result.covariance = covariance_;
  result.gyro = gyro_;
  if (outcome == ScanOutcome::kTooFewPoints) ++counters_.scans_too_few_points;
  if (outcome == ScanOutcome::kTooFewMatches) ++counters_.scans_too_few_matches;
  if (outcome == ScanOutcome::kUpdated || outcome == ScanOutcome::kFirst) ++counters_.scans_used;
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
