// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/calib/allan_variance.h"
#include "allan_lio/calib/sample_grid.h"
#include "allan_lio/calib/stillness.h"
#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

struct StaticRecordOptions {
  double rate = 0.0;                    ///< [Hz]; 0: learnt from the stamps, which are not looked at otherwise
  std::size_t max_samples = 1U << 24U;  ///< integrated values kept an axis; beyond, every second one is dropped
  int threads = 1;                      ///< the results do not depend on it
};

/// What was not as it should be.
struct RecordFaults {
  std::int64_t not_finite = 0;       ///< samples dropped for NaN or inf
  std::int64_t backward = 0;         ///< samples dropped for a stamp not later than the one before
  std::int64_t clock_set_back = 0;   ///< times that the clock went back for good; a new piece begins
  std::int64_t bridged_gaps = 0;     ///< short gaps, filled by a straight line
  std::int64_t bridged_samples = 0;  ///< samples missing in them
  std::int64_t long_gaps = 0;        ///< after which a new piece begins
  double longest_gap = 0.0;          ///< [s]
};

/// A record of an IMU at rest, integrated as it comes: samples are not kept, only the sums of six axes (0 to 2 gyro
/// x y z, 3 to 5 accelerometer x y z) at equal steps. When these fill their memory every second one is dropped, after
/// the Allan variances that need them have been computed.
class StaticRecord {
 public:
  static constexpr int kAxes = 6;
  static constexpr std::int64_t kLongestBridge = 10;  ///< samples

  /// Throws std::invalid_argument for a rate that is negative or not finite, or room for less than 64 values.
  explicit StaticRecord(const StaticRecordOptions& options = {});

  /// Readings in any units, see set_units().
  void add(const ImuSample& sample);

  /// Decides on what is still held back. Call it once, after the last sample and before any question.
  void finish();

  /// The readings times these are rad/s and m/s^2; 1 by default. May be called at any time.
  void set_units(double gyro, double accel);

  std::int64_t samples() const { return samples_; }  ///< used, without bridged ones
  double tau0() const;      ///< mean sampling interval [s]; 0 if unknown: fewer than two samples
  double duration() const;  ///< of all pieces together [s]
  std::size_t pieces() const { return series_[0].starts.size(); }
  double mean(int axis) const;       ///< [u]
  double deviation(int axis) const;  ///< of the readings [u]
  bool stamped() const { return options_.rate == 0.0; }
  double jitter() const;                           ///< of the stamps [s], see SampleGrid; 0 if they were not looked at
  std::int64_t stride() const { return stride_; }  ///< sampling intervals between the sums kept
  const RecordFaults& faults() const { return faults_; }

  /// One sentence each on jitter, gaps, dropped samples and decimation, where there is something to say.
  std::vector<std::string> remarks() const;

  /// A sentence if the sensor was moved, or empty.
  std::string motion() const;

  /// Allan variances at about `per_decade` factors a decade, up to a third of the longest piece.
  AllanCurve curve(int axis, int per_decade, int threads) const;

  /// The integral as it is kept: spacing stride() tau0().
  IntegratedSeries series(int axis) const;

 private:
  using Values = std::array<double, kAxes>;

  void add_unstamped(const ImuSample& sample);
  void start_grid();
  void settle(bool no_more);
  void take(const ImuSample& sample, std::int64_t missing);
  void begin_piece();
  void integrate(const Values& values);
  void keep();
  void decimate();
  void freeze();
  std::int64_t longest_piece() const;  // [samples]

  StaticRecordOptions options_;
  Values units_;

  std::unique_ptr<SampleGrid> grid_;
  std::unique_ptr<Stillness> stillness_;
  std::deque<ImuSample> held_;  // waiting for the decision whether samples are missing before them
  TimeNs last_stamp_ = 0;
  bool has_stamp_ = false, in_piece_ = false;
  int backward_in_a_row_ = 0;
  std::int64_t skipped_ = 0;  // samples without stamp that were dropped since the last good one

  Values offset_{};    // the first sample, taken off all [u]
  Values previous_{};  // the last sample, offset taken off [u]
  Values integral_{};  // since the piece's begin [u samples]
  Values sum_{}, squares_{};
  std::int64_t samples_ = 0, steps_ = 0;
  std::int64_t in_this_piece_ = 0;              // samples, bridged ones included
  std::array<IntegratedSeries, kAxes> series_;  // in units of [u samples], spacing stride_
  std::int64_t stride_ = 1;
  std::array<AllanCurve, kAxes> frozen_;  // variances that series_ no longer gives; times in samples
  RecordFaults faults_;
};

}  // namespace allan_lio
