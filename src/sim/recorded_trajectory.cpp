// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/recorded_trajectory.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "allan_lio/math/so3.h"
#include "quintic_spline.h"
#include "spline_fit.h"

namespace allan_lio {
namespace {

using Eigen::Vector3d;

constexpr double kLongestGap = 2.0;            // over which a spline would invent the way [s]
constexpr double kRunUp = 1.0, kTurnUp = 1.0;  // of the run-up from rest [m/s^2], [rad/s^2]
constexpr double kShortestRunUp = 0.5;         // [s]
constexpr double kStartWindow = 0.25;          // over which the record's first velocity is taken [s]

void check(const Trajectory& record, const RecordedOptions& options) {
  const auto require = [](bool good, const std::string& sentence) {
    if (!good) throw std::invalid_argument("recorded trajectory: " + sentence);
  };
  require(record.size() >= 4, "it needs four poses or more, there are " + std::to_string(record.size()));
  require(options.standstill >= 0, "the standstill cannot be negative");
  require(options.knot_interval > 0, "the knot interval must be positive");
  for (std::size_t i = 1; i < record.size(); ++i) {
    const double gap = seconds_between(record[i - 1].stamp, record[i].stamp);
    require(gap > 0, "the stamp " + format_seconds(record[i].stamp) + " is not later than the one before");
    require(gap <= kLongestGap, "nothing is known for " + std::to_string(gap) + " s from " +
                                    format_seconds(record[i - 1].stamp) + " on, more than 2 s");
  }
}

double median_spacing(const Trajectory& record) {
  std::vector<double> spacing;
  for (std::size_t i = 1; i < record.size(); ++i)
    spacing.push_back(seconds_between(record[i - 1].stamp, record[i].stamp));
  std::nth_element(spacing.begin(), spacing.begin() + spacing.size() / 2, spacing.end());
  return spacing[spacing.size() / 2];
}

/// From rest to the record's first velocity and rate.
class RunUp {
 public:
  explicit RunUp(const Trajectory& record) : first_(record.front().pose) {
    std::size_t i = 1;
    while (i + 1 < record.size() && seconds_between(record[0].stamp, record[i].stamp) < kStartWindow) ++i;
    const double window = seconds_between(record[0].stamp, record[i].stamp);
    velocity_ = (record[i].pose.translation - first_.translation) / window;
    rate_ = log_so3(first_.rotation.conjugate() * record[i].pose.rotation) / window;
    duration_ = std::max({kShortestRunUp, 1.5 * velocity_.norm() / kRunUp, 1.5 * rate_.norm() / kTurnUp});
  }

  double duration() const { return duration_; }

  /// `time` [s] before the record's first pose; before the run-up, at rest.
  RigidTransform pose(double time) const {
    const double u = std::max(0.0, 1.0 - time / duration_);
    // What is left of the integral of the speed 3u^2 - 2u^3.
    const double left = duration_ * (0.5 - (u * u * u - 0.5 * u * u * u * u));
    return {first_.rotation * exp_so3(-left * rate_), first_.translation - left * velocity_};
  }

 private:
  RigidTransform first_;
  Vector3d velocity_, rate_;
  double duration_;
};

/// Poses as samples of a spline, with quaternions that don't jump to their opposites.
class SampleList {
 public:
  SampleList(const RigidTransform& T_world_record, double knot_interval)
      : T_world_record_(T_world_record), knot_interval_(knot_interval) {}

  void add(double time, const RigidTransform& pose) {
    const RigidTransform placed = T_world_record_ * pose;
    SplineSample sample;
    sample.knots = time / knot_interval_;
    Eigen::Vector4d q = placed.rotation.coeffs();
    if (!samples.empty() && q.dot(samples.back().value.tail<4>()) < 0) q = -q;
    sample.value << placed.translation, q;
    samples.push_back(sample);
  }

  std::vector<SplineSample> samples;

 private:
  const RigidTransform& T_world_record_;
  double knot_interval_;
};

}  // namespace

RecordedTrajectory::RecordedTrajectory(const Trajectory& record, const RigidTransform& T_world_record,
                                       const RecordedOptions& options) {
  check(record, options);
  first_stamp_ = record.front().stamp;
  const double wish = std::max(options.knot_interval, 2.0 * median_spacing(record));
  const RunUp run_up(record);
  const bool rests = options.standstill > 0;
  // The pinned control points below reach half a spline's support beyond the standstill.
  if (rests) record_begin_ = options.standstill + 0.5 * kSplineOrder * wish + run_up.duration();
  const double total = record_begin_ + seconds_between(first_stamp_, record.back().stamp);
  const int segments = std::max(1, static_cast<int>(std::ceil(total / wish)));
  knot_interval_ = total / segments;

  SampleList list(T_world_record, knot_interval_);
  const int before = static_cast<int>(std::ceil(2.0 * record_begin_ / knot_interval_));
  for (int i = 0; i < before; ++i) {
    const double time = i * record_begin_ / before;
    list.add(time, run_up.pose(record_begin_ - time));
  }
  for (const StampedPose& pose : record) list.add(time_of(pose.stamp), pose.pose);

  const auto fitted = fit_quintic_spline(list.samples, segments);
  for (int i = 0; i < fitted.rows(); ++i) control_.push_back(fitted.row(i).transpose());
  const int pinned = rests ? static_cast<int>(std::ceil(options.standstill / knot_interval_)) + kSplineOrder - 1 : 0;
  for (int i = 0; i < pinned; ++i) control_[i] = list.samples.front().value;
  measure_misfit(record, T_world_record);
}

void RecordedTrajectory::measure_misfit(const Trajectory& record, const RigidTransform& T_world_record) {
  double position = 0.0, rotation = 0.0;
  for (const StampedPose& pose : record) {
    const RigidTransform truth = T_world_record * pose.pose, fit = at(time_of(pose.stamp)).T_world_imu;
    position += (fit.translation - truth.translation).squaredNorm();
    rotation += log_so3(truth.rotation.conjugate() * fit.rotation).squaredNorm();
  }
  position_misfit_ = std::sqrt(position / static_cast<double>(record.size()));
  rotation_misfit_ = std::sqrt(rotation / static_cast<double>(record.size()));
}

double RecordedTrajectory::duration() const {
  return static_cast<double>(control_.size() - (kSplineOrder - 1)) * knot_interval_;
}

MotionState RecordedTrajectory::at(double t) const {
  const double knots = std::max(0.0, std::min(t, duration())) / knot_interval_;
  const std::size_t segment = std::min(static_cast<std::size_t>(knots), control_.size() - kSplineOrder);
  const QuinticBasis basis = quintic_basis(knots - static_cast<double>(segment));
  Control value = Control::Zero(), first = Control::Zero(), second = Control::Zero();
  for (int i = 0; i < kSplineOrder; ++i) {
    value += basis.value[i] * control_[segment + i];
    first += basis.first[i] * control_[segment + i];
    second += basis.second[i] * control_[segment + i];
  }
  const Eigen::Quaterniond s(value[6], value[3], value[4], value[5]);
  const Eigen::Quaterniond s_dot(first[6], first[3], first[4], first[5]);

  MotionState state;
  state.T_world_imu = {s.normalized(), value.head<3>()};
  state.velocity_world = first.head<3>() / knot_interval_;
  state.acceleration_world = second.head<3>() / (knot_interval_ * knot_interval_);
  // The change of the length of s only enters the scalar part of s* s_dot, so the vector part is the normalised
  // quaternion's: q* q_dot = (0, rate/2).
  state.rate_imu = 2.0 * (s.conjugate() * s_dot).vec() / (s.squaredNorm() * knot_interval_);
  return state;
}

}  // namespace allan_lio
