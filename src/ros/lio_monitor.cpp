// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_monitor.h"

#include "allan_lio/lio/weak_axis.h"
#include "allan_lio/ros/finite.h"
#include "allan_lio/ros/status_message.h"
#include "allan_lio/ros/stopped_at_start.h"

namespace allan_lio {
namespace {

constexpr double kSilent = 2.0;       // [s] without a message
constexpr double kStartTakes = 10.0;  // [s] until the first result

/// From the stamp to now by the ROS clock [s]; 0 as long as a simulated clock has not come.
double age(const ros::Time& stamp) {
  const ros::Time now = ros::Time::now();
  return now.isZero() ? 0.0 : now.toSec() - stamp.toSec();
}

std::string silence(const char* what, const std::string& topic, const ros::WallTime& last) {
  if (last.isZero()) return std::string("no ") + what + " has come yet on " + topic;
  const int seconds = static_cast<int>((ros::WallTime::now() - last).toSec());
  return std::string("no ") + what + " for " + std::to_string(seconds) + " s on " + topic;
}

bool silent(const ros::WallTime& last, const ros::WallTime& begin) {
  return (ros::WallTime::now() - (last.isZero() ? begin : last)).toSec() > kSilent;
}

}  // namespace

LioMonitor::LioMonitor(ros::NodeHandle handle, ros::NodeHandle private_handle, const LioSession& session)
    : session_(session),
      status_(private_handle.advertise<Status>("status", 100)),
      updater_(handle, private_handle, private_handle.getNamespace()) {
  updater_.setHardwareID("none");
  require_running();
  updater_.add("odometry", this, &LioMonitor::diagnose);
  // Of wall time: a simulated clock that stands still is worth a diagnosis too.
  timer_ = handle.createWallTimer(ros::WallDuration(updater_.getPeriod()),
                                  [this](const ros::WallTimerEvent&) { updater_.force_update(); });
}

void LioMonitor::saw_imu(std::uint32_t number) {
  last_imu_ = ros::WallTime::now();
  imu_numbers_.add(number);
}

void LioMonitor::saw_cloud(std::optional<std::uint32_t> number, const std::string& refusal) {
  last_cloud_ = ros::WallTime::now();
  if (number) cloud_numbers_.add(*number);
  refusal_ = refusal;
}

void LioMonitor::count_new_losses(HealthFacts& facts) {
  std::uint64_t now = 0;
  for (const LossCount& loss :
       count_losses(session_.odometry().counters(), session_.undecodable(), lost_on_the_way())) {
    if (loss.reason.compare(0, 6, "points") == 0) continue;  // every scan has points out of range
    now += loss.count;
    facts.lost_because += (facts.lost_because.empty() ? "" : ", ") + loss.reason;
  }
  facts.newly_lost = now - lost_;
  lost_ = now;
}

void LioMonitor::saw_result(const LioResult& result) {
  last_result_ = ros::WallTime::now();
  window_.add(result, session_.scan_seconds());
  HealthFacts facts;
  count_new_losses(facts);
  facts.output_trouble = session_.output_trouble();
  const StatusPtr message = to_status_message(result, session_, window_, lost_on_the_way(), 0.0);
  facts.delay = message->delay = age(message->header.stamp);
  const Health health = judge_health(window_, result, facts);
  message->level = static_cast<std::uint8_t>(health.level);
  message->message = health.message;
  if (!publish_finite(status_, message)) return;
  last_ = *message;
  weak_axes_ = name_weak_axes(result);
}

Health LioMonitor::judge_surroundings() const {
  const LioConfig::Topics& topics = session_.odometry().config().topics;
  if (silent(last_imu_, begin_)) return {HealthLevel::kError, silence("IMU message", topics.imu, last_imu_)};
  if (silent(last_cloud_, begin_)) return {HealthLevel::kError, silence("cloud", topics.lidar, last_cloud_)};
  if (!session_.hopeless().empty()) return {HealthLevel::kError, session_.hopeless()};
  if (!refusal_.empty()) return {HealthLevel::kError, "cloud refused: " + refusal_};
  const double waited = (ros::WallTime::now() - (last_result_.isZero() ? begin_ : last_result_)).toSec();
  if (waited > kStartTakes) return {HealthLevel::kError, "messages come, but no scan can be used"};
  if (!session_.output_trouble().empty()) return {HealthLevel::kError, session_.output_trouble()};
  if (last_result_.isZero()) return {HealthLevel::kWarn, "waits for the start"};
  return {};
}

void LioMonitor::diagnose(diagnostic_updater::DiagnosticStatusWrapper& report) {
  const Health around = judge_surroundings();
  const bool around_is_worse = static_cast<int>(around.level) > static_cast<int>(last_.level);
  report.summary(around_is_worse ? static_cast<unsigned char>(around.level) : last_.level,
                 around_is_worse ? around.message : last_.message);
  report.add("mean NIS per degree of freedom", last_.nis_mean);
  report.addf("honest NIS", "%.3f to %.3f", last_.nis_low, last_.nis_high);
  report.add("inliers", last_.inliers);
  report.addf("probability by direction", "%.2f %.2f %.2f %.2f %.2f %.2f", last_.probability[0], last_.probability[1],
              last_.probability[2], last_.probability[3], last_.probability[4], last_.probability[5]);
  report.add("weak axes in " + session_.odometry().config().frames.odom, weak_axes_);
  const auto add_bias = [&report](const char* name, const geometry_msgs::Vector3& b, const geometry_msgs::Vector3& s) {
    report.addf(name, "%.3g %.3g %.3g +- %.2g %.2g %.2g", b.x, b.y, b.z, s.x, s.y, s.z);
  };
  add_bias("gyro bias [rad/s]", last_.gyro_bias, last_.gyro_bias_sigma);
  add_bias("accelerometer bias [m/s^2]", last_.accel_bias, last_.accel_bias_sigma);
  if (!session_.output_trouble().empty()) report.add("results", session_.output_trouble());
  report.add("delay [s]", last_.delay);
  report.addf("CPU per scan [ms]", "%.2f", 1e3 * last_.scan_time_mean);
  report.addf("map [MB]", "%.2f of %.0f", last_.map_mb, last_.map_max_mb);
  report.addf("k_g k_a k_gb k_ab k_r", "%g %g %g %g %g", last_.k_g, last_.k_a, last_.k_gb, last_.k_ab, last_.k_r);
  for (const Count& count : last_.dropped) report.add(count.reason, count.count);
}

}  // namespace allan_lio
