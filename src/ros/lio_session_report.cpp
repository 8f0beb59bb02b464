// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// What a session says of its run.
#include <utility>

#include "allan_lio/ros/lio_session.h"

namespace allan_lio {
namespace {

/// Clouds in a row that may fail before the run is given up.
constexpr std::uint64_t kHopelessClouds = 50;

}  // namespace

std::string LioSession::hopeless() const {
  if (decoded_ == 0 && undecodable_ >= kHopelessClouds) return last_refusal_;
  return odometry_->counters().scans_used == 0 ? clocks_.trouble() : "";
}

std::string LioSession::why_nothing() const {
  const LioCounters& c = odometry_->counters();
  if (c.scans_used > 0) return "";
  if (!clocks_.trouble().empty()) return clocks_.trouble();
  if (undecodable_ > 0 && decoded_ == 0) return "no cloud could be decoded: " + last_refusal_;
  if (decoded_ == 0) return "no scan came";
  if (c.imu_read == 0) return "no IMU sample came";
  const auto part = [](std::uint64_t count, const char* what) {
    return count == 0 ? std::string() : ", " + std::to_string(count) + " " + what;
  };
  return "of " + std::to_string(c.scans_read) + " scans none was used" +
         part(c.scans_before_imu, "begin before the first IMU sample or the end of the initialisation") +
         part(c.scans_after_imu, "end after the last IMU sample") + part(c.scans_dropped_order, "out of order") +
         part(c.scans_overflow, "waited for IMU data in vain") + part(c.scans_too_few_points, "with too few points") +
         part(c.scans_too_few_matches, "with too few matches");
}

void LioSession::finish(const std::string& status) {
  if (std::exchange(finished_, true) || !writer_) return;
  RunSummary summary;
  summary.counters = odometry_->counters();
  summary.map_megabytes = odometry_->map_megabytes();
  summary.map_voxels = odometry_->map_voxels();
  summary.notes = notes_;
  summary.notes.insert(summary.notes.begin(), noise_report_.begin(), noise_report_.end());
  for (const std::string& remark : remarks_.sentences()) summary.notes.push_back(remark);
  for (const std::string& remark : decoder_.remarks()) summary.notes.push_back(remark);
  if (!verdict().empty()) summary.notes.insert(summary.notes.begin(), verdict());
  if (undecodable_ > 0)
    summary.notes.push_back(std::to_string(undecodable_) +
                            " messages could not be decoded; the last: " + last_refusal_);
  if (restarts_ > 0) summary.notes.push_back(restarted_ + " (" + std::to_string(restarts_) + " times in all)");
  if (!relocated_.empty())
    summary.notes.push_back(relocated_ + " (" + std::to_string(summary.counters.places_found) + " times in all)");
  summary.inputs = inputs_;
  summary.status = status;
  writer_->finish(summary);
}

}  // namespace allan_lio
