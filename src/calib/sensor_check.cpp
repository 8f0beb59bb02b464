// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/sensor_check.h"

#include <algorithm>
#include <cmath>

#include "sensor_check_words.h"

namespace allan_lio {
namespace {

constexpr double kSlowImu = 50.0;          // [Hz] below which a walk's jolts are lost between samples
constexpr double kBridged = 0.1;           // [s] a gap of the IMU up to this costs nothing worth saying
constexpr double kFewPoints = 300.0;       // in a scan
constexpr double kUnevenStamps = 0.3;      // of the interval
constexpr double kGravityOff = 0.3;        // [m/s^2]
constexpr double kLargeGyroBias = 0.05;    // [rad/s]
constexpr double kFastestGyro = 40.0;      // [rad/s]; 2000 deg/s is the widest range of common gyros
constexpr double kSuspiciousDelay = 0.15;  // [s]
constexpr double kLeastOverlap = 0.5;      // of the shorter record

/// Collects the sentences.
class Judge {
 public:
  explicit Judge(const SensorCheck& check) : check_(check) {}

  std::vector<SensorFinding> run() {
    for (const std::string& trouble : check_.troubles) warn(trouble);
    if (!check_.imu) fatal("there is no topic of sensor_msgs/Imu with messages: without an IMU nothing runs");
    if (!check_.lidar) fatal("there is no topic of point clouds with messages: nothing corrects the IMU");
    if (check_.imu) {
      judge_stream(*check_.imu, "IMU");
      judge_imu(*check_.imu);
    }
    if (check_.lidar) {
      judge_stream(*check_.lidar, "LiDAR");
      judge_lidar(*check_.lidar);
    }
    if (check_.imu && check_.lidar) judge_clocks(*check_.imu, *check_.lidar);
    return findings_;
  }

 private:
  void warn(const std::string& sentence) { findings_.push_back({false, sentence}); }
  void fatal(const std::string& sentence) { findings_.push_back({true, sentence}); }

  void judge_stream(const SensorCheck::Stream& s, const std::string& name) {
    if (s.stamps.not_newer > 0)
      warn(count_of(s.stamps.not_newer) + " " + name +
           " stamps are not newer than the one before: these messages are " +
           "dropped, and a step back by more than a second starts the estimator anew");
    if (s.stamps.jitter > kUnevenStamps * s.stamps.interval)
      warn("the " + name + "'s stamps are uneven, by " + milliseconds(s.stamps.jitter) +
           ": they are probably taken at " + "arrival, not by the sensor's clock; motion between them is smeared");
    if (s.frames.count("") > 0) warn("the " + name + "'s frame_id is empty: TF cannot give its extrinsics");
    if (s.frames.size() > 1)
      warn("the " + name + "'s frame_id changes (" + list(s.frames) + "): two sensors on one topic?");
    if (s.undecodable > 0) warn(count_of(s.undecodable) + " " + name + " messages cannot be decoded");
  }

  void judge_imu(const SensorCheck::Imu& imu) {
    const ImuReport& r = imu.readings;
    if (r.frozen) return fatal("the IMU's readings never change: it sends nothing of its own");
    if (imu.stamps.count < 2 || imu.stamps.interval <= 0.0) return fatal("the IMU's stamps do not go forward");
    if (imu.stamps.rate() < kSlowImu)
      warn("the IMU comes at " + hertz(imu.stamps.rate()) + " only: fast motion is lost between its samples");
    if (imu.stamps.longest_gap > kBridged)
      warn("the IMU is silent for up to " + seconds(imu.stamps.longest_gap) + " (" + count_of(imu.stamps.gaps) +
           " gaps): the estimate is inflated there, and starts again after more than imu/max_gap");
    if (r.invalid > 0) warn(count_of(r.invalid) + " IMU samples are NaN, inf or absurd: they are dropped");
    if (std::abs(r.gravity - 9.80665) > kGravityOff && r.standstill >= ImuReport::kEnoughStandstill)
      warn("at rest the accelerometer reads " + number(r.gravity) +
           " m/s^2, which is neither 1 g nor 9.81 m/s^2: a scale error, another unit, or gravity is taken off");
    if (r.standstill < ImuReport::kEnoughStandstill)
      warn("the record begins in motion: tilt and velocity start with a large uncertainty and take some seconds");
    else if (r.gyro_bias.cwiseAbs().maxCoeff() > kLargeGyroBias)
      warn("the gyro's bias of " + number(r.gyro_bias.norm()) +
           " rad/s is large: if the gyro reads in deg/s, convert it; if not, it takes it for motion unless "
           "imu/noise/gyro_turn_on_bias allows it");
    if (r.largest_rate > kFastestGyro)
      warn("the gyro reads up to " + number(r.largest_rate) +
           " rad/s: it probably reads in deg/s, and must be converted");
    judge_clipping(r.gyro_clipping, "gyro", "rad/s", "imu/gyro_range");
    judge_clipping(r.accel_clipping, "accelerometer", "m/s^2", "imu/accel_range");
  }

  void judge_clipping(const Clipping& c, const std::string& sensor, const std::string& unit, const std::string& key) {
    if (c.samples == 0) return;
    warn("the " + sensor + " saturates at " + number(c.at) + " " + unit + " (" + count_of(c.samples) +
         " readings): set " + key + " to it, so that their noise is inflated");
  }

  void judge_lidar(const SensorCheck::Lidar& lidar) {
    if (lidar.undecodable >= lidar.stamps.count) return fatal("no cloud can be decoded: " + lidar.refusal);
    if (!lidar.deskew)
      warn(
          "the points' times cannot be used, so lidar/deskew is off in the suggestion and a scan is blurred by its "
          "motion, unless it is compensated already (" +
          lidar.refusal + ")");
    else if (lidar.point_time != PointTime::kAuto)
      warn(
          "the points' times are of another clock than the stamps; that the stamp marks the sweep's start is a guess: "
          "compare lidar/point_time: start and end");
    else if (lidar.undecodable > 0)
      warn("the last refused cloud: " + lidar.refusal);
    if (lidar.points < kFewPoints)
      warn("a scan holds " + number(lidar.points) + " points only: few planes will be found");
    if (lidar.sweep > 1.2 * lidar.stamps.interval && lidar.stamps.interval > 0.0)
      warn("a sweep lasts " + seconds(lidar.sweep) + ", longer than from one scan to the next (" +
           seconds(lidar.stamps.interval) + "): scans overlap, or the time's unit is wrong");
    if (lidar.stamps.gaps > 0)
      warn("scans are missing: " + count_of(lidar.stamps.gaps) + " gaps of up to " + seconds(lidar.stamps.longest_gap) +
           ", which the IMU has to bridge");
    for (const std::string& remark : lidar.remarks) warn(remark);
  }

  void judge_clocks(const SensorCheck::Imu& imu, const SensorCheck::Lidar& lidar) {
    const TimeNs begin = std::max(imu.stamps.first, lidar.stamps.first);
    const TimeNs end = std::min(imu.stamps.last, lidar.stamps.last);
    const double shorter = std::min(seconds_between(imu.stamps.first, imu.stamps.last),
                                    seconds_between(lidar.stamps.first, lidar.stamps.last));
    const double common = seconds_between(begin, end);
    const std::string ranges = "the IMU's stamps go " + range(imu.stamps) + ", the LiDAR's " + range(lidar.stamps);
    if (common <= 0.0) return fatal("the sensors' clocks have nothing in common: " + ranges);
    if (common < kLeastOverlap * shorter) warn("only " + seconds(common) + " have both sensors: " + ranges);
    const double apart = lidar.delay - imu.delay;
    if (std::abs(apart) > kSuspiciousDelay)
      warn("scans arrive " + milliseconds(apart) + " later after their end than IMU samples after their stamp: the " +
           "clocks differ, or the driver holds scans back; if the clocks differ, set lidar/time_offset");
  }

  const SensorCheck& check_;
  std::vector<SensorFinding> findings_;
};

}  // namespace

std::vector<SensorFinding> judge_sensors(const SensorCheck& check) { return Judge(check).run(); }

}  // namespace allan_lio
