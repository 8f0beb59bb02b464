// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "allan_lio/math/rigid_transform.h"
#include "allan_lio/math/time.h"

namespace allan_lio {

/// The pose of a body at a time: pose = T_world_body.
struct StampedPose {
  TimeNs stamp = 0;
  RigidTransform pose;
};
using Trajectory = std::vector<StampedPose>;

/// Seconds with nine decimals, exact: "1315.000000001".
std::string format_seconds(TimeNs stamp);

/// The other way, exact to the nanosecond; digits beyond the ninth are rounded to the nearest. Takes plain decimals
/// and exponents ("1.3150e+09"). False if `text` is not a number or does not fit.
bool parse_seconds(const std::string& text, TimeNs* stamp);

/// One line "t x y z qx qy qz qw" (metres, Hamilton quaternion), numbers so that reading gives back the same bits.
std::string format_tum_line(const StampedPose& pose);

/// Reads TUM lines, numbers parted by blanks or commas, '#' begins a comment. Quaternions are normalised.
/// Throws std::runtime_error as "name:line: sentence" for a line that is not eight finite numbers, for a zero
/// quaternion, for a stamp that is not later than the one before, and if there is no pose at all.
Trajectory read_tum(std::istream& in, const std::string& name);
Trajectory read_tum(const std::string& path);

/// Throws std::runtime_error naming the path if it cannot be written.
void write_tum(const std::string& path, const Trajectory& trajectory);

}  // namespace allan_lio
