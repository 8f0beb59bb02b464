// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "allan_lio/io/tum.h"
#include "allan_lio/math/time.h"
#include "allan_lio/sim/motion.h"

namespace allan_lio {

struct RecordedOptions {
  /// Rest that is put before the record [s]. Where the record begins in motion, a run-up from rest (about 1 m/s^2)
  /// joins the two. 0: the trajectory begins with the record, moving or not.
  double standstill = 3.0;
  double knot_interval = 0.1;  ///< of the spline, made longer for sparse records: two samples a knot or more [s]
};

/// A recorded motion as a smooth one: position and quaternion components are one uniform quintic B-spline fitted by
/// least squares; the quaternion is normalised where it is used, and its derivative gives the exact body rate.
///
/// Clock: the record's first stamp lies at the trajectory's time record_begin(), which is 0 without standstill:
/// stamp = first_stamp() + (t - record_begin()). time_of() says it the other way.
class RecordedTrajectory : public Motion {
 public:
  /// `T_world_record` places the record, as by place_record() or align_record(). Throws std::invalid_argument for
  /// fewer than four poses, a gap of more than 2 s, a negative standstill or a knot interval that is not positive.
  RecordedTrajectory(const Trajectory& record, const RigidTransform& T_world_record,
                     const RecordedOptions& options = {});

  double duration() const override;
  MotionState at(double t) const override;

  double record_begin() const { return record_begin_; }  ///< [s]
  TimeNs first_stamp() const { return first_stamp_; }
  double time_of(TimeNs stamp) const { return record_begin_ + seconds_between(first_stamp_, stamp); }  ///< [s]

  double position_misfit() const { return position_misfit_; }  ///< rms of fit minus record [m]
  double rotation_misfit() const { return rotation_misfit_; }  ///< rms angle between fit and record [rad]

 private:
  using Control = Eigen::Matrix<double, 7, 1>;  ///< x y z, qx qy qz qw (any length)

  void measure_misfit(const Trajectory& record, const RigidTransform& T_world_record);

  std::vector<Control> control_;
  double knot_interval_ = 0.0, record_begin_ = 0.0;
  TimeNs first_stamp_ = 0;
  double position_misfit_ = 0.0, rotation_misfit_ = 0.0;
};

/// Puts the record's first pose at `start` [m] and turns the record by `yaw` [rad] about the vertical.
RigidTransform place_record(const Trajectory& record, const Eigen::Vector3d& start, double yaw);

/// Turns the record about the vertical so that it is narrowest across the direction `heading` [rad], ends ahead of
/// where it began, and has the middle of its box at `centre` [m].
RigidTransform align_record(const Trajectory& record, const Eigen::Vector3d& centre, double heading);

}  // namespace allan_lio
