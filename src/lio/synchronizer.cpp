// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/synchronizer.h"

#include <utility>

namespace allan_lio {

void Synchronizer::add_imu(const ImuSample& sample) {
  ++counters_.imu_read;
  const ImuGate::Passed passed = gate_.pass(sample);
  if (passed.absurd) ++counters_.imu_dropped_invalid;
  if (passed.wrong_stamp) ++counters_.imu_dropped_order;
  if (passed.kept_back) take_imu(*passed.kept_back);
  if (passed.sample) take_imu(*passed.sample);
}

void Synchronizer::take_imu(const ImuSample& sample) {
  if (!imu_.push(sample)) {
    ++counters_.imu_dropped_order;
    return;
  }
  if (!first_imu_) first_imu_ = sample.stamp;
  if (scans_.empty()) imu_.discard_before(sample.stamp - to_ns(kKeptWithoutScans));
}

std::size_t Synchronizer::set_accel_scale(double scale) {
  if (gate_.set_accel_scale(scale)) ++counters_.imu_dropped_invalid;
  const std::size_t dropped = imu_.remove_if([scale](const ImuSample& sample) { return !is_sane(sample, scale); });
  counters_.imu_dropped_invalid += dropped;
  if (dropped > 0) first_imu_ = imu_.empty() ? std::nullopt : std::make_optional(imu_.oldest());
  return dropped;
}

void Synchronizer::end_of_data() {
  if (const std::optional<ImuSample> last = gate_.release()) take_imu(*last);
  if (suspect_scan_) take_scan(std::move(*suspect_scan_));
  suspect_scan_.reset();
  ended_ = true;
}

void Synchronizer::begin_again(TimeNs t, Scan scan) {
  imu_.discard_before(t);
  first_imu_ = imu_.oldest();
  scans_.push_front(std::move(scan));
}

void Synchronizer::add_scan(Scan scan) {
  ++counters_.scans_read;
  counters_.points_invalid += scan.dropped_invalid;
  counters_.points_out_of_range += scan.dropped_range;
  if (suspect_scan_) {
    const bool was_right = scan.end() > suspect_scan_->end();
    if (was_right) take_scan(std::move(*suspect_scan_));
    if (!was_right) ++counters_.scans_dropped_order;
    suspect_scan_.reset();
  } else if (newest_scan_end_ && seconds_between(*newest_scan_end_, scan.end()) > kSuspiciousLeap) {
    suspect_scan_ = std::move(scan);
    return;
  }
  take_scan(std::move(scan));
}

void Synchronizer::take_scan(Scan scan) {
  if (newest_scan_end_ && scan.end() <= *newest_scan_end_) {
    ++counters_.scans_dropped_order;
    return;
  }
  newest_scan_end_ = scan.end();
  if (scans_.size() == kMostWaiting) {
    ++counters_.scans_overflow;
    scans_.pop_front();
  }
  scans_.push_back(std::move(scan));
}

const Scan* Synchronizer::front() {
  while (first_imu_ && !scans_.empty() && scans_.front().begin() < *first_imu_) {
    ++counters_.scans_before_imu;
    scans_.pop_front();
  }
  return first_imu_ && !scans_.empty() ? &scans_.front() : nullptr;
}

std::optional<Scan> Synchronizer::take() {
  const Scan* oldest = front();
  if (!oldest) {
    if (ended_) counters_.scans_after_imu += scans_.size(), scans_.clear();  // there never was an IMU sample
    return std::nullopt;
  }
  const double missing = seconds_between(imu_.newest(), oldest->end());
  if (missing > 0 && !ended_) return std::nullopt;
  if (missing > kBridge) {
    counters_.scans_after_imu += scans_.size();
    scans_.clear();
    return std::nullopt;
  }
  std::optional<Scan> out(std::move(scans_.front()));
  scans_.pop_front();
  return out;
}

}  // namespace allan_lio
