// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace allan_lio {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kOrder = 6;  // control points that one segment of a quintic spline depends on

/// A function of time with its first two derivatives.
struct Jet {
  double v = 0.0, d = 0.0, dd = 0.0;
};

Jet operator+(const Jet& a, const Jet& b) { return {a.v + b.v, a.d + b.d, a.dd + b.dd}; }
Jet operator*(double s, const Jet& a) { return {s * a.v, s * a.d, s * a.dd}; }
Jet operator*(const Jet& a, const Jet& b) {
  return {a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + 2.0 * a.d * b.d + a.v * b.dd};
}
Jet sin(const Jet& a) {
  const double s = std::sin(a.v), c = std::cos(a.v);
  return {s, c * a.d, c * a.dd - s * a.d * a.d};
}
Jet cos(const Jet& a) {
  const double s = std::sin(a.v), c = std::cos(a.v);
  return {c, -s * a.d, -s * a.dd - c * a.d * a.d};
}

/// Weights of the six control points at `u` in [0, 1] of a segment, with their derivatives by u.
struct Basis {
  double value[kOrder], first[kOrder], second[kOrder];
};

/// The uniform quintic B-spline's polynomials, times 120, by rising powers of u.
constexpr double kPolynomial[kOrder][kOrder] = {{1, -5, 10, -10, 5, -1},  {26, -50, 20, 20, -20, 5},
                                                {66, 0, -60, 0, 30, -10}, {26, 50, 20, -20, -20, 10},
                                                {1, 5, 10, 10, 5, -5},    {0, 0, 0, 0, 0, 1}};

Basis quintic_basis(double u) {
  Basis basis;
  for (int i = 0; i < kOrder; ++i) {
    double value = 0.0, first = 0.0, half_second = 0.0;
    for (int power = kOrder - 1; power >= 0; --power) {  // Horner's scheme for a polynomial and its derivatives
      half_second = half_second * u + first;
      first = first * u + value;
      value = value * u + kPolynomial[i][power];
    }
    basis.value[i] = value / 120.0;
    basis.first[i] = first / 120.0;
    basis.second[i] = 2.0 * half_second / 120.0;
  }
  return basis;
}

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
  const auto resting = [h](double seconds) { return kOrder + static_cast<int>(std::ceil(seconds / h - 1e-9)); };
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

}  // namespace

SimTrajectory::SimTrajectory(const TrajectoryPlan& plan) : knot_interval_(plan.knot_interval), gait_(plan.gait) {
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

double SimTrajectory::duration() const { return static_cast<double>(control_.size() - (kOrder - 1)) * knot_interval_; }

MotionState SimTrajectory::at(double t) const {
  const double knots = std::max(0.0, std::min(t, duration())) / knot_interval_;
  const std::size_t segment = std::min(static_cast<std::size_t>(knots), control_.size() - kOrder);
  const Basis basis = quintic_basis(knots - static_cast<double>(segment));
  Control value = Control::Zero(), first = Control::Zero(), second = Control::Zero();
  for (int i = 0; i < kOrder; ++i) {
    value += basis.value[i] * control_[segment + i];
    first += basis.first[i] * control_[segment + i];
    second += basis.second[i] * control_[segment + i];
  }
  const auto channel = [&](Channel c) {
    return Jet{value[c], first[c] / knot_interval_, second[c] / (knot_interval_ * knot_interval_)};
  };
  const auto swing = [&](double rate, double phase, double amplitude) {
    const double omega = 2.0 * kPi * rate;
    return amplitude * (channel(kWeight) * sin(Jet{omega * t + phase, omega, 0.0}));
  };
  const double step = gait_.step_rate, stride = 0.5 * gait_.step_rate;
  const Jet lateral = swing(stride, 0.0, gait_.lateral);
  const Jet x = channel(kX) + -1.0 * (lateral * sin(channel(kHeading)));
  const Jet y = channel(kY) + lateral * cos(channel(kHeading));
  const Jet z = channel(kZ) + swing(step, 0.7, gait_.vertical);
  const Jet yaw = channel(kHeading) + swing(stride, 2.1, gait_.yaw);
  const Jet pitch = swing(step, 1.3, gait_.pitch), roll = swing(stride, 0.4, gait_.roll);

  MotionState state;
  state.T_world_imu.translation << x.v, y.v, z.v;
  state.velocity_world << x.d, y.d, z.d;
  state.acceleration_world << x.dd, y.dd, z.dd;
  state.T_world_imu.rotation = Eigen::AngleAxisd(yaw.v, Eigen::Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(pitch.v, Eigen::Vector3d::UnitY()) *
                               Eigen::AngleAxisd(roll.v, Eigen::Vector3d::UnitX());
  const double sr = std::sin(roll.v), cr = std::cos(roll.v), sp = std::sin(pitch.v), cp = std::cos(pitch.v);
  state.rate_imu << roll.d - yaw.d * sp, pitch.d * cr + yaw.d * cp * sr, -pitch.d * sr + yaw.d * cp * cr;
  return state;
}

}  // namespace allan_lio
