// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_session.h"

#include <cstdio>
#include <ctime>
#include <exception>
#include <utility>

#include "allan_lio/imu/noise_report.h"
#include "allan_lio/io/live_parameters.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/lio/health.h"
#include "allan_lio/ros/conversions.h"

namespace allan_lio {
namespace {

constexpr std::uint64_t kRateSamples = 100;  // that the IMU's rate is told from
constexpr double kLongestInterval = 0.1;     // [s] between IMU samples; longer is a gap

double process_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Adds the CPU time of its life to `sum`.
class CpuMeter {
 public:
  explicit CpuMeter(double& sum) : sum_(sum), begin_(process_cpu_seconds()) {}
  ~CpuMeter() { sum_ += process_cpu_seconds() - begin_; }
  CpuMeter(const CpuMeter&) = delete;
  CpuMeter& operator=(const CpuMeter&) = delete;

 private:
  double& sum_;
  double begin_;
};

}  // namespace

LioSession::LioSession(const LioConfig& config, const std::string& out, OnResult on_result)
    : odometry_(std::make_unique<Odometry>(config)),
      config_hash_(allan_lio::config_hash(config)),
      decoder_(config.lidar),
      on_result_(std::move(on_result)) {
  if (!out.empty()) writer_ = std::make_unique<RunWriter>(out, config);
}

LioSession::~LioSession() {
  try {
    finish("interrupted");
  } catch (const std::exception&) {
    // A destructor has nobody to tell; RunWriter has kept what could be kept.
  }
}

void LioSession::add(const sensor_msgs::Imu& message) {
  remarks_.imu_frame(message.header.frame_id);
  const ImuSample sample = to_imu_sample(message);
  TimeNs before = watch_.newest();
  if (watch_.begins_anew(sample.stamp)) restart(before = sample.stamp);
  const double step = seconds_between(before, sample.stamp);
  if (step > 0.0 && step < kLongestInterval) {
    imu_seconds_ += step;
    ++imu_steps_;
    const LioConfig::Imu& imu = odometry_->config().imu;
    if (imu_steps_ == kRateSamples)
      noise_report_ = describe_noise(imu.spec, imu.scale, static_cast<double>(imu_steps_) / imu_seconds_);
  }
  clocks_.add_imu(watch_.newest());
  odometry_->add_imu(sample);
  take_results();
}

void LioSession::restart(TimeNs stamp) {
  char back[40];
  std::snprintf(back, sizeof back, "%.3f", seconds_between(stamp, watch_.newest()));
  restarted_ = "the stamps went back by " + std::string(back) + " s: the estimator has started again, with a new map";
  ++restarts_;
  end_of_data();
  odometry_->restart();
  watch_ = RecordingWatch();
  watch_.begins_anew(stamp);
  clocks_.begin_again();
  new_cloud_to_come_ = true;
}

std::string LioSession::add(const RawCloud& message) {
  const std::string error = add_cloud(message, stamp_of(message).value_or(0));
  if (error.empty()) remarks_.lidar_frame(frame_of(message));
  return error;
}

std::string LioSession::add(const sensor_msgs::PointCloud2& message) {
  remarks_.lidar_frame(message.header.frame_id);
  return add_cloud(message, to_time_ns(message.header.stamp));
}

template <class Cloud>
std::string LioSession::add_cloud(const Cloud& message, TimeNs stamp) {
  if (new_cloud_to_come_ && stamp > watch_.newest() + RecordingWatch::kBackInTime) return "";
  new_cloud_to_come_ = false;
  std::string error;
  {
    CpuMeter meter(pending_seconds_);
    DecodedCloud decoded = decoder_.decode(message);
    error = std::move(decoded.error);
    if (decoded.scan) clocks_.add_scan(decoded.scan->begin());
    if (decoded.scan) odometry_->add_scan(std::move(*decoded.scan));
    decoded.scan ? ++decoded_ : ++undecodable_;
  }
  if (!error.empty()) last_refusal_ = error;
  take_results();
  return error;
}

void LioSession::count_undecodable(const std::string& why) {
  ++undecodable_;
  last_refusal_ = why;
}

void LioSession::take_results() {
  for (;;) {
    std::optional<LioResult> result;
    {
      CpuMeter meter(pending_seconds_);
      result = odometry_->next();
    }
    if (!result) return;
    remarks_.accel_scale(odometry_->accel_scale());
    if (writer_) writer_->add(*result, pending_seconds_);
    scan_seconds_ = std::exchange(pending_seconds_, 0.0);
    cpu_seconds_ += scan_seconds_;
    last_result_ = result->state.nav.stamp;
    take_note(*result);
    if (on_result_) on_result_(*result);
  }
}

void LioSession::take_note(const LioResult& result) {
  const bool used = result.outcome != ScanOutcome::kTooFewPoints && result.outcome != ScanOutcome::kTooFewMatches;
  if (used) clocks_.begin_again();
  if (!result.relocated.isZero(0.0))
    relocated_ = moment() + describe_relocation(result.relocated) + " (update/relocalize)";
  if (odometry_->counters().starts_in_place == starts_in_place_) return;
  starts_in_place_ = odometry_->counters().starts_in_place;
  restarted_ = moment() +
               "the IMU was silent for longer than imu/max_gap and no scan filled in: the estimator has "
               "started again where it stood, with a new map";
  ++restarts_;
}

std::string LioSession::moment() const {
  return last_result_ == 0 ? "before the first scan: " : "at " + format_seconds(last_result_) + ": ";
}

void LioSession::reconfigure(const LioConfig& config) {
  const std::string difference = live_difference(odometry_->config(), config);
  odometry_->reconfigure(config);
  config_hash_ = allan_lio::config_hash(config);
  if (writer_) writer_->reconfigure(config);
  if (!difference.empty()) add_note(moment() + difference);
}

void LioSession::reset() {
  end_of_data();
  add_note(moment() + "started again on request, with a new map");
  odometry_->restart();
}

void LioSession::set_pose(const PoseAnchor& anchor) {
  odometry_->set_pose(anchor);
  add_note(moment() + "pose set on request, with a new map");
}

void LioSession::end_of_data() {
  odometry_->end_of_data();
  take_results();
}

double LioSession::imu_interval() const {
  return imu_steps_ == 0 ? 0.0 : imu_seconds_ / static_cast<double>(imu_steps_);
}

}  // namespace allan_lio
