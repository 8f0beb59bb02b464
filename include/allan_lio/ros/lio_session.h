// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/io/run_writer.h"
#include "allan_lio/lio/clock_check.h"
#include "allan_lio/lio/odometry.h"
#include "allan_lio/ros/decode_cloud.h"
#include "allan_lio/ros/recording_watch.h"
#include "allan_lio/ros/sensor_remarks.h"

namespace allan_lio {

/// One run of the estimator on ROS messages: decode, feed, take the results, write them. The offline runner, the
/// node and the nodelet drive this same object, so they give the same results to the bit.
class LioSession {
 public:
  /// Called with every result, after it has been written; may be empty.
  using OnResult = std::function<void(const LioResult&)>;

  /// `out`: directory of the results, empty for none. Throws std::runtime_error if it cannot be written.
  LioSession(const LioConfig& config, const std::string& out, OnResult on_result);

  /// Writes what there is with status "interrupted" if finish() was not called. Whoever wants to hear of a file that
  /// could not be written calls finish().
  ~LioSession();

  /// When the stamps go back by more than a second and stay there (a bag in a loop, a clock set anew), the estimator
  /// settles what it has and starts again.
  void add(const sensor_msgs::Imu& message);

  /// A cloud of any type. Why it could not be decoded; empty if it could.
  std::string add(const RawCloud& message);
  std::string add(const sensor_msgs::PointCloud2& message);

  /// A message that could not even be deserialised.
  void count_undecodable(const std::string& why);

  /// Takes effect with the next scan (Odometry::reconfigure()); goes into the summary, whose parameters are those in
  /// force at the end, and its notes.
  void reconfigure(const LioConfig& config);

  /// Settles what there is and starts again with the data to come, at the origin and with a new map.
  void reset();

  /// Odometry::set_pose(); goes into the summary's notes.
  void set_pose(const PoseAnchor& anchor);

  /// For the summary.
  void add_note(const std::string& note) { notes_.push_back(note); }
  void set_inputs(const std::vector<std::string>& inputs) { inputs_ = inputs; }

  /// No more data comes: settles the scans that wait.
  void end_of_data();

  /// Completes the files. Throws std::runtime_error naming the file that could not be written. Does nothing when
  /// called again.
  void finish(const std::string& status);
  bool finished() const { return finished_; }

  /// One line on the point times, empty as long as nothing is known.
  std::string verdict() const { return decoder_.verdict(); }

  /// The IMU noise in force at the rate of its first samples (noise_report.h); empty before that.
  const std::vector<std::string>& noise_report() const { return noise_report_; }

  /// What a user should know of the sensors' data, a sentence each: the accelerometer's unit, odd frame_ids.
  const std::vector<std::string>& remarks() const { return remarks_.sentences(); }

  /// Why no scan can be used at present though both sensors speak: their clocks lie apart. Else empty.
  std::string clock_trouble() const { return clocks_.trouble(); }

  /// Not empty when no scan was ever used and it is of no use to go on: so many clouds in a row could not be decoded,
  /// or the clocks lie apart.
  std::string hopeless() const;

  /// A sentence on the last time that the estimator started again, empty if it never did.
  const std::string& restarted() const { return restarted_; }
  std::uint64_t restarts() const { return restarts_; }

  /// A sentence on the last time that the pose jumped to where the scan fitted the map from before (PlaceSearch),
  /// empty if it never did.
  const std::string& relocated() const { return relocated_; }

  /// Why results are lost on their way to the disk (RunWriter::trouble()), empty if none are.
  std::string output_trouble() const { return writer_ ? writer_->trouble() : ""; }

  /// Why no scan was used, empty if one was.
  std::string why_nothing() const;

  const Odometry& odometry() const { return *odometry_; }
  const std::string& config_hash() const { return config_hash_; }  ///< of the parameters in force
  std::uint64_t undecodable() const { return undecodable_; }
  double cpu_seconds() const { return cpu_seconds_; }    ///< of decoding, registration and map so far [s]
  double scan_seconds() const { return scan_seconds_; }  ///< of that for the last result [s]
  double imu_interval() const;                           ///< mean time between IMU samples [s], 0 if unknown

 private:
  template <class Cloud>
  std::string add_cloud(const Cloud& message, TimeNs stamp);
  void take_results();
  void restart(TimeNs stamp);
  /// What a result says of the run besides the state.
  void take_note(const LioResult& result);
  /// "at 1600000012.300: ", the stamp of the last result.
  std::string moment() const;

  std::unique_ptr<Odometry> odometry_;
  std::string config_hash_;
  CloudDecoder decoder_;
  std::unique_ptr<RunWriter> writer_;
  OnResult on_result_;
  std::vector<std::string> notes_, inputs_, noise_report_;
  SensorRemarks remarks_;
  std::string last_refusal_;
  std::uint64_t decoded_ = 0, undecodable_ = 0, imu_steps_ = 0;
  RecordingWatch watch_;
  ClockCheck clocks_;
  std::uint64_t starts_in_place_ = 0;
  double imu_seconds_ = 0.0;        ///< sum of imu_steps_ intervals between samples [s]
  bool new_cloud_to_come_ = false;  ///< clouds from before the restart may still be on their way
  std::string restarted_;
  std::uint64_t restarts_ = 0;
  std::string relocated_;
  double pending_seconds_ = 0.0;  ///< CPU time spent since the last result [s]
  double cpu_seconds_ = 0.0, scan_seconds_ = 0.0;
  TimeNs last_result_ = 0;  ///< its stamp
  bool finished_ = false;
};

}  // namespace allan_lio
