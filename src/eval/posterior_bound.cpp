// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/eval/posterior_bound.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "allan_lio/eval/dead_reckoning.h"
#include "allan_lio/math/so3.h"
#include "posterior_covariance.h"
#include "slide.h"

namespace allan_lio {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr TimeNs kStampSlack = 1000;  // by which stamps may be rounded [ns]
constexpr double kStanding = 0.001;   // by which a standing body seems to move and turn [m], [rad]

/// The truth at about the step asked for: its own poses, none interpolated.
Trajectory thinned(const Trajectory& truth, double step) {
  Trajectory kept;
  for (const StampedPose& pose : truth)
    if (kept.empty() || pose.stamp - kept.back().stamp >= to_ns(step) - kStampSlack) kept.push_back(pose);
  return kept;
}

/// By central differences [m/s].
std::vector<Eigen::Vector3d> velocities(const Trajectory& truth) {
  std::vector<Eigen::Vector3d> found;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const StampedPose &a = truth[i > 0 ? i - 1 : 0], &b = truth[std::min(i + 1, truth.size() - 1)];
    const double dt = seconds_between(a.stamp, b.stamp);
    found.push_back(dt > 0.0 ? Eigen::Vector3d((b.pose.translation - a.pose.translation) / dt)
                             : Eigen::Vector3d::Zero());
  }
  return found;
}

/// Until when the truth stands at its start.
TimeNs standstill_end(const Trajectory& truth) {
  const auto stands = [&start = truth.front().pose](const RigidTransform& pose) {
    return (pose.translation - start.translation).norm() < kStanding &&
           pose.rotation.angularDistance(start.rotation) < kStanding;
  };
  std::size_t last = 0;
  while (last + 1 < truth.size() && stands(truth[last + 1].pose)) ++last;
  return truth[last].stamp;
}

/// Walks along the truth with the covariance of an ideal filter.
class BoundWalk {
 public:
  BoundWalk(const Trajectory& truth, const AxisChoice& axis, const BoundOptions& options)
      : truth_(thinned(truth, options.step)),
        velocity_(velocities(truth_)),
        standstill_end_(standstill_end(truth_)),
        ground_(axis.kind == AxisKind::kWeakest),
        options_(options),
        covariance_(options),
        next_scan_(truth_.front().stamp + to_ns(options.interval)) {
    const Eigen::Vector3d fixed = axis.kind == AxisKind::kGiven ? axis.given.normalized() : main_axis(truth);
    slides_ = axis.kind == AxisKind::kMotion ? slides_along(truth_, fixed)
                                             : std::vector<Slide>(truth_.size(), {fixed, Eigen::Vector3d::Zero()});
  }

  /// The bound of the next stretch; NaN if the truth does not reach its end.
  double through(const BlindStretch& stretch) {
    if (!walk_to(stretch.begin, false)) return kNaN;
    covariance_.anchor_position();
    if (ground_) covariance_.anchor_heading(rotation(), velocity_[at_]);
    return walk_to(stretch.end, true) ? position_sigma() : kNaN;
  }

 private:
  Eigen::Matrix3d rotation() const { return truth_[at_].pose.rotation.toRotationMatrix(); }

  /// With all scans up to the first pose at `stamp` or later. False if there is none, or a gap before.
  bool walk_to(TimeNs stamp, bool blind) {
    if (stamp < truth_.front().stamp) return false;
    while (truth_[at_].stamp < stamp - kStampSlack) {
      if (at_ + 1 == truth_.size()) return false;
      const double dt = seconds_between(truth_[at_].stamp, truth_[at_ + 1].stamp);
      if (dt > options_.max_gap) return false;
      covariance_.propagate(step(dt), truth_[at_ + 1].pose.translation - truth_[at_].pose.translation);
      ++at_;
      if (truth_[at_].stamp < next_scan_ - kStampSlack) continue;
      covariance_.measure(rotation(), blind ? unseen() : BodyMotions(6, 0));
      if (truth_[at_].stamp <= standstill_end_) covariance_.stand();
      while (next_scan_ <= truth_[at_].stamp + kStampSlack) next_scan_ += to_ns(options_.interval);
    }
    return true;
  }

  DiscreteModel step(double dt) const {
    NavState state;
    state.T_world_imu = truth_[at_].pose;
    const Eigen::Quaterniond& from = truth_[at_].pose.rotation;
    const Eigen::Vector3d turn = log_so3(from.conjugate() * truth_[at_ + 1].pose.rotation);
    const Eigen::Vector3d force = (velocity_[at_ + 1] - velocity_[at_]) / dt - state.gravity_world;
    const Eigen::Quaterniond middle = from * exp_so3(0.5 * turn);
    return discretize(state, {dt, turn / dt, middle.conjugate() * force}, options_.noise, Discretization::kVanLoan);
  }

  BodyMotions unseen() const {
    BodyMotions motions = BodyMotions::Zero(6, ground_ ? 3 : 1);
    if (ground_) {
      motions(2, 0) = 0.01;  // a radian is as large as a hundred metres
      motions(3, 1) = motions(4, 2) = 1.0;
    } else {
      motions << slides_[at_].turn, slides_[at_].axis;
    }
    return motions;
  }

  double position_sigma() const {
    const Eigen::Matrix3d position = covariance_.position();
    if (!ground_) return std::sqrt(std::max(0.0, slides_[at_].axis.dot(position * slides_[at_].axis)));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> horizontal(position.topLeftCorner<2, 2>());
    return std::sqrt(std::max(0.0, horizontal.eigenvalues()[1]));
  }

  Trajectory truth_;
  std::vector<Eigen::Vector3d> velocity_;
  TimeNs standstill_end_;
  std::vector<Slide> slides_;
  bool ground_;
  BoundOptions options_;
  PosteriorCovariance covariance_;
  std::size_t at_ = 0;
  TimeNs next_scan_;
};

}  // namespace

BoundOptions bound_options(const NoiseSpec& spec) {
  BoundOptions options;
  options.noise = make_imu_noise(spec, {}, BiasModel::kRandomWalk);
  const auto sigma = [](const SensorNoise& sensor) -> Eigen::Vector3d {
    return (sensor.turn_on_bias.cwiseAbs2() + bias_spread(sensor).cwiseAbs2()).cwiseSqrt();
  };
  options.gyro_bias_sigma = sigma(spec.gyro);
  options.accel_bias_sigma = sigma(spec.accel);
  return options;
}

std::vector<double> posterior_bounds(const Trajectory& truth, const AxisChoice& axis,
                                     const std::vector<BlindStretch>& stretches, const BoundOptions& options) {
  if (!(std::min({options.position_sigma, options.rotation_sigma, options.standing_sigma, options.interval,
                  options.step}) > 0.0))
    throw std::invalid_argument("the bound needs positive sigmas of scans and standstill, interval and step");
  for (std::size_t i = 0; i < stretches.size(); ++i)
    if (stretches[i].end <= stretches[i].begin || (i > 0 && stretches[i].begin < stretches[i - 1].end))
      throw std::invalid_argument("the stretches without support must follow one another in time");
  if (truth.empty()) return std::vector<double>(stretches.size(), kNaN);
  BoundWalk walk(truth, axis, options);
  std::vector<double> bounds;
  for (const BlindStretch& stretch : stretches) bounds.push_back(walk.through(stretch));
  return bounds;
}

void add_bounds(const Trajectory& truth, const AxisChoice& axis, const BoundOptions& options,
                ConsistencySummary& summary) {
  const std::vector<double> bounds = posterior_bounds(truth, axis, summary.blind, options);
  const AxialNoise noise{options.noise.accel_psd.x(), options.noise.accel_bias_psd.x()};
  for (std::size_t i = 0; i < bounds.size(); ++i) {
    BlindStretch& stretch = summary.blind[i];
    stretch.bound = StretchBound{bounds[i], kNaN};
    if (axis.kind != AxisKind::kWeakest)
      stretch.bound->known_tilt =
          portal_to_portal_sigma(noise, options.position_sigma, options.interval, stretch.seconds);
  }
}

}  // namespace allan_lio
