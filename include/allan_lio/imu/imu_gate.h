// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "allan_lio/imu/imu_sample.h"

namespace allan_lio {

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

  /// At the end of the data: the sample that is still kept back.
  std::optional<ImuSample> release();

 private:
  std::optional<ImuSample> suspect_;
  std::optional<TimeNs> newest_;
};

}  // namespace allan_lio
