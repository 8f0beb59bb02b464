// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "slide.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "allan_lio/eval/consistency.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

constexpr TimeNs kDirectionSpan = 2 * kNsPerSecond;  // before and after [ns]
constexpr double kLeastHalf = 0.25;                  // share of the chord that either half needs to tell a turn

}  // namespace

std::vector<Slide> slides_along(const Trajectory& truth, const Eigen::Vector3d& if_never) {
  std::vector<Slide> slides;
  std::size_t before = 0, after = 0, standing = 0;
  Slide slide{if_never, Eigen::Vector3d::Zero()};
  for (const StampedPose& pose : truth) {
    while (truth[before].stamp < pose.stamp - kDirectionSpan) ++before;
    while (after + 1 < truth.size() && truth[after].stamp < pose.stamp + kDirectionSpan) ++after;
    const Eigen::Vector3d behind = pose.pose.translation - truth[before].pose.translation,
                          ahead = truth[after].pose.translation - pose.pose.translation, chord = behind + ahead;
    slide.turn.setZero();
    if (chord.norm() > kMovingSpeed * seconds_between(truth[before].stamp, truth[after].stamp)) {
      slide.axis = chord.normalized();
      // The halves of an arc differ in direction by the turn over half of its length.
      if (std::min(behind.norm(), ahead.norm()) > kLeastHalf * chord.norm())
        slide.turn = log_so3(Eigen::Quaterniond::FromTwoVectors(behind, ahead)) / (0.5 * chord.norm());
    } else if (standing == slides.size()) {
      ++standing;
    }
    slides.push_back(slide);
  }
  if (standing < slides.size())
    std::fill_n(slides.begin(), standing, Slide{slides[standing].axis, Eigen::Vector3d::Zero()});
  return slides;
}

}  // namespace allan_lio
