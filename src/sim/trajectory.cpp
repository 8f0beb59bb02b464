// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "jet.h"
#include "quintic_spline.h"

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
void require(bool good, const std::string& sentence) {
  if (!good) throw std::invalid_argument("trajectory: " + sentence);
}

void check(const TrajectoryPlan& plan) {
  require(plan.waypoints.size() >= 2, "a plan needs two waypoints or more");
  for (std::size_t i = 1; i < plan.waypoints.size(); ++i) {
    const std::string which = "waypoint " + std::to_string(i);
    require(plan.waypoints[i].speed > 0, which + " has a speed that is not positive");
    require((plan.waypoints[i].position - plan.waypoints[i - 1].position).norm() > 1e-3,
            which + " lies where the one before it lies");
  }
  require(plan.acceleration > 0, "acceleration must be positive");
  require(plan.knot_interval > 0, "knot_interval must be positive");
  require(plan.standstill_begin >= 0 && plan.standstill_end >= 0, "a standstill cannot be negative");
  require(plan.gait.full_speed > 0, "gait.full_speed must be positive");
  require(std::isfinite(plan.lean), "lean must be a number");
  for (const Wobble& wobble : plan.wobbles)
    require(wobble.frequency > 0 && std::isfinite(wobble.amplitude) && std::isfinite(wobble.phase),
            "a wobble needs a positive frequency and a finite amplitude and phase");
}

/// The waypoints' polyline by arc length.
class Polyline {
 public:
  explicit Polyline(const std::vector<Waypoint>& waypoints) : waypoints_(waypoints), arc_(waypoints.size(), 0.0) {
    for (std::size_t i = 1; i < arc_.size(); ++i)
      arc_[i] = arc_[i - 1] + (waypoints[i].position - waypoints[i - 1].position).norm();
  }

  double length() const { return arc_.back(); }

  Eigen::Vector3d position(double arc) const {
    const std::size_t i = leg(arc);
    const double along = (arc - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
    return waypoints_[i - 1].position + along * (waypoints_[i].position - waypoints_[i - 1].position);
  }

  /// The highest speed at `arc` from which every slower leg ahead, and the end, can be met.
  double allowed_speed(double arc, double acceleration) const {
    double speed = waypoints_[leg(arc)].speed;
    for (std::size_t i = leg(arc); i < arc_.size(); ++i) {
      const double then = i + 1 < arc_.size() ? waypoints_[i + 1].speed : 0.0;
      speed = std::min(speed, std::sqrt(then * then + 2.0 * acceleration * std::max(0.0, arc_[i] - arc)));
    }
    return speed;
  }

 private:
  /// Index of the waypoint at the end of the leg that holds `arc`.
  std::size_t leg(double arc) const {
    const std::size_t i = std::upper_bound(arc_.begin(), arc_.end(), arc) - arc_.begin();
    return std::min(std::max<std::size_t>(i, 1), arc_.size() - 1);
  }

  const std::vector<Waypoint>& waypoints_;
  std::vector<double> arc_;
};

/// Arc lengths at the knots, standstills included: at either end so many equal ones that the spline rests for
/// the whole of the standstill; one more, because speed and heading look at the neighbours.
std::vector<double> arc_at_knots(const Polyline& line, const TrajectoryPlan& plan) {
  const double h = plan.knot_interval;
  const auto resting = [h](double seconds) { return kSplineOrder + static_cast<int>(std::ceil(seconds / h - 1e-9)); };
  std::vector<double> arcs(resting(plan.standstill_begin), 0.0);
  double speed = 0.0;
  while (arcs.back() < line.length()) {
    const double arc = arcs.back();
    // The second term: a last crawl would never arrive.
    speed = std::max(std::min(speed + plan.acceleration * h, line.allowed_speed(arc, plan.acceleration)),
                     0.5 * plan.acceleration * h);
    arcs.push_back(std::min(arc + speed * h, line.length()));
  }
  arcs.insert(arcs.end(), resting(plan.standstill_end), line.length());
  return arcs;
}

/// `angle` moved by whole turns to within half a turn of `near`.
double unwrap(double angle, double near) { return angle - 2.0 * kPi * std::round((angle - near) / (2.0 * kPi)); }

/// Position [m] and angles [rad], rotation Rz(yaw) Ry(pitch) Rx(roll).
struct Pose {
  Jet x, y, z, roll, pitch, yaw;
};

/// Sinusoids that swell with the gait's weight.
struct Swing {
  double t;
  Jet weight;

  Jet operator()(double rate, double phase, double amplitude) const {
    const double omega = 2.0 * kPi * rate;
    return amplitude * (weight * sin(Jet{omega * t + phase, omega, 0.0}));
  }
};

void add_gait(const Gait& gait, const Swing& swing, const Jet& heading, Pose& pose) {
  const double step = gait.step_rate, stride = 0.5 * gait.step_rate;
  const Jet lateral = swing(stride, 0.0, gait.lateral);
  pose.x = pose.x + -1.0 * (lateral * sin(heading));
  pose.y = pose.y + lateral * cos(heading);
  pose.z = pose.z + swing(step, 0.7, gait.vertical);
  pose.yaw = heading + swing(stride, 2.1, gait.yaw);
  pose.pitch = swing(step, 1.3, gait.pitch);
  pose.roll = swing(stride, 0.4, gait.roll);
}

void add_wobbles(const std::vector<Wobble>& wobbles, const Swing& swing, const Jet& heading, Pose& pose) {
  Jet shake[6];  // by Wobble::Axis: displacements [m] and angles [rad]
  for (const Wobble& wobble : wobbles) {
    const double omega = 2.0 * kPi * wobble.frequency;
    const double scale = wobble.axis < Wobble::kRoll ? 1.0 / (omega * omega) : 1.0 / omega;
    shake[wobble.axis] = shake[wobble.axis] + swing(wobble.frequency, wobble.phase, scale * wobble.amplitude);
  }
  pose.x = pose.x + shake[Wobble::kForward] * cos(heading) + -1.0 * (shake[Wobble::kLeft] * sin(heading));
  pose.y = pose.y + shake[Wobble::kForward] * sin(heading) + shake[Wobble::kLeft] * cos(heading);
  pose.z = pose.z + shake[Wobble::kUp];
  pose.roll = pose.roll + shake[Wobble::kRoll];
  pose.pitch = pose.pitch + shake[Wobble::kPitch];
  pose.yaw = pose.yaw + shake[Wobble::kYaw];
}

MotionState state_of(const Pose& pose) {
  const Jet &roll = pose.roll, &pitch = pose.pitch, &yaw = pose.yaw;
  MotionState state;
  state.T_world_imu.translation << pose.x.v, pose.y.v, pose.z.v;
  state.velocity_world << pose.x.d, pose.y.d, pose.z.d;
  state.acceleration_world << pose.x.dd, pose.y.dd, pose.z.dd;
  state.T_world_imu.rotation = Eigen::AngleAxisd(yaw.v, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch.v, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll.v, Eigen::Vector3d::UnitX());
  const double sr = std::sin(roll.v), cr = std::cos(roll.v), sp = std::sin(pitch.v), cp = std::cos(pitch.v);
  state.rate_imu << roll.d - yaw.d * sp, pitch.d * cr + yaw.d * cp * sr, -pitch.d * sr + yaw.d * cp * cr;
  return state;
}

}  // namespace

SimTrajectory::SimTrajectory(const TrajectoryPlan& plan)
    : knot_interval_(plan.knot_interval), gait_(plan.gait), lean_(plan.lean), wobbles_(plan.wobbles) {
  check(plan);
  const Polyline line(plan.waypoints);
  const std::vector<double> arcs = arc_at_knots(line, plan);
  const Eigen::Vector3d start = plan.waypoints[1].position - plan.waypoints[0].position;
  double heading = std::atan2(start.y(), start.x());
  for (std::size_t i = 0; i < arcs.size(); ++i) {
    const double before = arcs[i == 0 ? 0 : i - 1], after = arcs[std::min(i + 1, arcs.size() - 1)];
    const Eigen::Vector3d chord = line.position(after) - line.position(before);
    if (chord.head<2>().norm() > 1e-6) heading = unwrap(std::atan2(chord.y(), chord.x()), heading);
    const double speed = 0.5 * (after - before) / knot_interval_;
    Control control;
    control << line.position(arcs[i]), heading, std::min(1.0, speed / gait_.full_speed);
    control_.push_back(control);
  }
}

double SimTrajectory::duration() const {
  return static_cast<double>(control_.size() - (kSplineOrder - 1)) * knot_interval_;
}

MotionState SimTrajectory::at(double t) const {
  const double knots = std::max(0.0, std::min(t, duration())) / knot_interval_;
  const std::size_t segment = std::min(static_cast<std::size_t>(knots), control_.size() - kSplineOrder);
  const QuinticBasis basis = quintic_basis(knots - static_cast<double>(segment));
  Control value = Control::Zero(), first = Control::Zero(), second = Control::Zero(), third = Control::Zero();
  for (int i = 0; i < kSplineOrder; ++i) {
    value += basis.value[i] * control_[segment + i];
    first += basis.first[i] * control_[segment + i];
    second += basis.second[i] * control_[segment + i];
    third += basis.third[i] * control_[segment + i];
  }
  const double h = knot_interval_, h2 = h * h;
  const auto channel = [&](Channel c) { return Jet{value[c], first[c] / h, second[c] / h2}; };
  const Jet heading = channel(kHeading);
  Pose pose{channel(kX), channel(kY), channel(kZ), {}, {}, heading};
  const Swing swing{t, channel(kWeight)};
  add_gait(gait_, swing, heading, pose);
  if (!wobbles_.empty()) add_wobbles(wobbles_, swing, heading, pose);
  if (lean_ != 0.0) {
    // Angles need one derivative only, so the jerk is enough.
    const Jet ax{second[kX] / h2, third[kX] / (h2 * h), 0.0}, ay{second[kY] / h2, third[kY] / (h2 * h), 0.0};
    pose.pitch = pose.pitch + lean_ * (ax * cos(heading) + ay * sin(heading));
    pose.roll = pose.roll + lean_ * (ax * sin(heading) + -1.0 * (ay * cos(heading)));
  }
  return state_of(pose);
}

}  // namespace allan_lio
