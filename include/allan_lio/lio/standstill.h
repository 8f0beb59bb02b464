// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/lidar/deskew.h"
#include "allan_lio/lio/absolute_covariance.h"
#include "allan_lio/lio/update_step.h"

namespace allan_lio {

/// Tells for how long an IMU that stands at the start goes on standing: as long as it reads its own noise about the
/// same means. For that it must read no more than noise in the first place; one on a running engine is not watched.
class Standstill {
 public:
  /// With a record of 2 readings or more [rad/s, m/s^2] that was taken for one of a standstill.
  void begin(const std::vector<ImuSample>& record, const NoiseSpec& spec);
  void end() { lasts_ = false; }

  /// With the readings up to the next scan. A gap in them ends it: nobody knows what happened.
  void go_on(const std::vector<TrackSegment>& track);

  bool lasts() const { return lasts_; }
  TimeNs recorded_until() const { return recorded_until_; }  ///< the end of that record

 private:
  using Readings = Eigen::Array<double, 6, 1>;  ///< rate [rad/s], specific force [m/s^2], IMU frame

  void compare(const Readings& mean, double seconds);

  bool lasts_ = false;
  TimeNs recorded_until_ = 0;
  Readings mean_ = Readings::Zero();
  Readings psd_ = Readings::Zero();  ///< of white noise [(rad/s)^2/Hz, (m/s^2)^2/Hz]
  double seconds_ = 0.0;             ///< that the mean is of [s]
};

/// Kalman update with what a standstill at `pose`, which is exact in the filter's world, tells: pose and zero velocity.
/// The `first` one only sets these anew: what they tell of biases and gravity is known from the same readings already.
/// Gives false, and changes nothing, if the filter knows of a motion (chi^2) or does not know its velocity to 0.1 m/s.
bool update_standstill(const RigidTransform& pose, bool first, LioState& state, Belief& belief,
                       AbsoluteCovariance& absolute);

}  // namespace allan_lio
