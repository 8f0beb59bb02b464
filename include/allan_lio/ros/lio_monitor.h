// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/Status.h>
#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/wall_timer.h>

#include <cstdint>
#include <optional>
#include <string>

#include "allan_lio/lio/health.h"
#include "allan_lio/ros/lio_session.h"
#include "allan_lio/ros/sequence_watch.h"

namespace allan_lio {

/// ~status after every scan, and /diagnostics every ~diagnostic_period, which go on when the sensors are silent. The
/// latter is global, not ~diagnostics: there REP 107 and the aggregators look for it, and each robot's names tell
/// whose.
class LioMonitor {
 public:
  /// `session` must outlive this.
  LioMonitor(ros::NodeHandle handle, ros::NodeHandle private_handle, const LioSession& session);

  /// `number`: of the message's header.
  void saw_imu(std::uint32_t number);
  /// `number`: of the message's header, if it has one. `refusal`: why the cloud was not decoded, empty if it was.
  void saw_cloud(std::optional<std::uint32_t> number, const std::string& refusal);
  void saw_result(const LioResult& result);

  /// The estimator starts again.
  void clear() { window_.clear(); }

 private:
  void diagnose(diagnostic_updater::DiagnosticStatusWrapper& report);
  /// What is wrong with the input, or with the files of the results, if anything is.
  Health judge_surroundings() const;
  LostOnTheWay lost_on_the_way() const { return {imu_numbers_.lost(), cloud_numbers_.lost()}; }
  /// Sets what came up since the last call.
  void count_new_losses(HealthFacts& facts);

  const LioSession& session_;
  HealthWindow window_;
  Status last_;                            ///< as published
  std::string weak_axes_ = "no scan yet";  ///< of the last result
  SequenceWatch imu_numbers_, cloud_numbers_;
  std::uint64_t lost_ = 0;
  std::string refusal_;
  ros::WallTime begin_ = ros::WallTime::now(), last_imu_, last_cloud_, last_result_;
  ros::Publisher status_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};

}  // namespace allan_lio
