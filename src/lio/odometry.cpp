// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/odometry.h"

#include <algorithm>
#include <utility>

#include "odometry_impl.h"

namespace allan_lio {

/// The whole pipeline.
LioResult Odometry::Impl::process(Scan scan) {
  const std::vector<TrackSegment> track = propagate_to(scan.end());
  standstill_.go_on(track);
  select_points(scan);
  LioResult result = begin_result(scan);
  deskewer_.reset();
  if (result.registered < config_.lidar.min_points) return finish(ScanOutcome::kTooFewPoints, std::move(scan), result);

  const NavState predicted = state_.nav;
  deskewer_ = make_deskewer(scan, track, predicted);
  deskew_points(scan);
  if (map_->voxels() == 0) {
    make_first_pose();
    insert_scan();
    return finish(start_.again ? ScanOutcome::kMapRestarted : ScanOutcome::kFirst, std::move(scan), result);
  }

  if (may_stand_still()) settle_standstill();
  const UpdateReport report = register_scan(scan, result);
  result.standing = hold_standstill();
  if (!report.applied) return finish(settle_unmatched(), std::move(scan), result);

  updated_at_ = state_.nav.stamp;
  unmatched_in_a_row_ = 0;
  map_proven_ = true;
  if (config_.estimate_extrinsics) {  // the points lie elsewhere now
    deskewer_ = make_deskewer(scan, track, predicted);
    deskew_points(scan);
  }
  if (is_distorted(scan, predicted.velocity_world)) found_map_again(scan, track);
  if (map_->voxels() == 0 || moved_since_insertion()) insert_scan();
  return finish(ScanOutcome::kUpdated, std::move(scan), result);
}

std::optional<LioResult> Odometry::Impl::next() {
  for (;;) {
    if (!initialized_ && !initialize_from_imu()) return std::nullopt;
    std::optional<Scan> scan = synchronizer_.take();
    if (!scan) return std::nullopt;
    const ImuBuffer::Silence silence = blind_until(scan->end());
    if (silence.seconds <= config_.imu.max_gap) return process(std::move(*scan));
    start_in_place(silence, std::move(*scan));
  }
}

Odometry::Odometry(const LioConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Odometry::~Odometry() = default;
void Odometry::add_imu(const ImuSample& sample) { impl_->synchronizer_.add_imu(sample); }
void Odometry::add_scan(Scan scan) { impl_->synchronizer_.add_scan(std::move(scan)); }
void Odometry::end_of_data() { impl_->synchronizer_.end_of_data(); }
std::optional<LioResult> Odometry::next() { return impl_->next(); }
std::vector<WorldPoint> Odometry::deskewed_points() const { return impl_->deskewed_points(); }
std::vector<WorldPoint> Odometry::map_points() const { return impl_->map_points(); }
double Odometry::map_megabytes() const { return 1e-6 * static_cast<double>(impl_->map_->bytes()); }
std::size_t Odometry::map_voxels() const { return impl_->map_->voxels(); }
const LioCounters& Odometry::counters() const { return impl_->counters_; }
const LioConfig& Odometry::config() const { return impl_->config_; }
double Odometry::accel_scale() const { return impl_->accel_scale_; }
void Odometry::reconfigure(const LioConfig& config) { impl_->reconfigure(config); }
void Odometry::set_pose(const PoseAnchor& anchor) { impl_->set_pose(anchor); }

void Odometry::restart() {
  auto fresh = std::make_unique<Impl>(impl_->config_);
  fresh->counters_ = impl_->counters_;
  impl_ = std::move(fresh);
}

}  // namespace allan_lio
