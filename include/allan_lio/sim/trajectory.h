// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "allan_lio/sim/motion.h"

namespace allan_lio {

/// A place on the way, and the speed on the leg that leads to it.
struct Waypoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  double speed = 1.0;                                  ///< [m/s]
};

/// The periodic motion that a walking person or a rolling car adds to the way: amplitudes at full speed.
/// Vertical and pitch go with the step, lateral, roll and yaw with every second step.
struct Gait {
  double step_rate = 1.87;  ///< [Hz]
  double vertical = 0.025;  ///< [m]
  double lateral = 0.02;    ///< [m]
  double roll = 0.026;      ///< [rad]
  double pitch = 0.014;     ///< [rad]
  double yaw = 0.012;       ///< [rad]
  double full_speed = 0.5;  ///< from which the amplitudes are full [m/s]
};

/// One sinusoid of a vibration that the body really makes, at full speed; it swells with the gait.
struct Wobble {
  enum Axis : int { kForward, kLeft, kUp, kRoll, kPitch, kYaw };
  Axis axis;
  double frequency;  ///< [Hz]
  double amplitude;  ///< of the acceleration [m/s^2], or of the angular rate [rad/s]
  double phase;      ///< [rad]
};

struct TrajectoryPlan {
  std::vector<Waypoint> waypoints;  ///< world frame; the first one's speed is not used
  double standstill_begin = 3.0;    ///< [s]
  double standstill_end = 1.0;      ///< [s]
  double acceleration = 1.0;        ///< along the way, never exceeded by the speed profile before smoothing [m/s^2]
  double knot_interval = 0.4;       ///< of the spline; a longer one rounds the corners more [s]
  Gait gait;
  /// How far the body leans into an acceleration [rad/(m/s^2)]: 1/g for a multirotor, which flies where its thrust
  /// points; negative for a car, which rolls outward in a bend and nods when it brakes.
  double lean = 0.0;
  std::vector<Wobble> wobbles;
};

/// A smooth motion along a plan: position, heading (x forward) and the gait's weight are one uniform quintic
/// B-spline (C^4); what gait, lean and wobbles add is in closed form.
class SimTrajectory : public Motion {
 public:
  /// Throws std::invalid_argument for fewer than two waypoints, two equal ones in a row, or a number that is not
  /// positive where it must be.
  explicit SimTrajectory(const TrajectoryPlan& plan);

  double duration() const override;
  MotionState at(double t) const override;

 private:
  enum Channel : int { kX, kY, kZ, kHeading, kWeight, kChannels };
  using Control = Eigen::Matrix<double, kChannels, 1>;

  std::vector<Control, Eigen::aligned_allocator<Control>> control_;
  double knot_interval_;
  Gait gait_;
  double lean_;
  std::vector<Wobble> wobbles_;
};

}  // namespace allan_lio
