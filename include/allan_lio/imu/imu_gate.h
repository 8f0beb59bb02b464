// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

/// True for what an IMU can have measured: finite, not longer than 50 g and 100 rad/s. `accel_scale`: factor from the
/// readings to m/s^2.
bool is_sane(const ImuSample& sample, double accel_scale);

/// Keeps from an estimator what no IMU measures: readings that are not finite or absurd, and a stamp far ahead of its
/// time, which would make all that follow old.
class ImuGate {
 public:
  static constexpr double kSuspiciousLeap = 1.0;  ///< [s] ahead of the sample before

  /// What one sample lets through, in the order of time.
  struct Passed {
    std::optional<ImuSample> kept_back;  ///< the one before, which was far ahead: there was a gap, its stamp was right
    std::optional<ImuSample> sample;
    bool absurd = false;       ///< the sample is dropped for its values
    bool wrong_stamp = false;  ///< the one that was kept back is dropped
  };

  /// `sample` as the sensor gives it. One that is far ahead is kept back until the next tells a gap from a wrong stamp.
  Passed pass(const ImuSample& sample);

  /// Factor from the accelerometer's readings to m/s^2. It is 1 until it is set: so nothing is dropped that is right
  /// in either unit, and of a sensor in g what is less than 9.8 times too long passes. Whoever learns the unit later
  /// goes over what has passed by is_sane(). True if the sample that is kept back is absurd by the new factor: then it
  /// is dropped.
  bool set_accel_scale(double scale);
  double accel_scale() const { return accel_scale_; }

  /// At the end of the data: the sample that is still kept back.
  std::optional<ImuSample> release();

 private:
  double accel_scale_ = 1.0;
  std::optional<ImuSample> suspect_;
  std::optional<TimeNs> newest_;
};

}  // namespace allan_lio
