// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "allan_lio/eval/consistency.h"
#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/io/tum.h"

namespace allan_lio {

/// An IMU and a LiDAR that is as good as one may hope for. Bias and tilt are known only as their measurements leave
/// them: standing or going straight tells their sum, a turn tells them apart.
struct BoundOptions {
  ImuNoise noise;
  Eigen::Vector3d gyro_bias_sigma = Eigen::Vector3d::Zero();   ///< at the start [rad/s]
  Eigen::Vector3d accel_bias_sigma = Eigen::Vector3d::Zero();  ///< at the start [m/s^2]
  double velocity_sigma = 0.05;                                ///< at the start, per axis [m/s]
  double gravity_sigma = 0.1;                                  ///< of gravity's direction at the start, per axis [rad]
  double position_sigma = 0.002;                               ///< of a scan, per axis [m]
  double rotation_sigma = 1e-4;                                ///< of a scan, per axis [rad]
  double standing_sigma = 0.001;  ///< of the velocity at a scan of the standstill at the start, per axis [m/s]
  double interval = 0.1;          ///< between scans [s]
  double step = 0.02;             ///< of the propagation along the truth [s]
  double max_gap = 0.5;           ///< longest step that is taken where the truth is sparse [s]
};

/// Biases as random walks that start with the turn-on figure and the spread (bias_spread) together.
BoundOptions bound_options(const NoiseSpec& spec);

/// 1 sigma [m] of the position that an ideal filter gains through each stretch in which its scans tell nothing of what
/// is blind there. (A filter may be surer where they tell a little.)
///
/// A covariance analysis along the truth, without states or drawn noise: the 17 errors of NavIndex, linearised where
/// the truth is. The world is the truth's first pose, and the truth's own world must be level (gravity along -z); rate
/// and specific force are differentiated from the poses. Every `interval` a scan measures the pose against the map that
/// was made so far, and a standstill at the start is known as one. Inside a stretch a scan does not see the motion
/// since the last one
/// * along the axis: path and given; or motion, the way's direction over four seconds, with the turn that goes with a
///   slide along its bend (a round tunnel that bends looks the same after it); or
/// * in both horizontal directions and about the vertical (AxisKind::kWeakest, flat ground),
/// and what slid stays so in the map: later scans see nothing of it. The figure is the sigma at the stretch's end along
/// the axis, or that of the larger principal axis of the horizontal position. Position, and on flat ground heading,
/// count from the stretch's begin.
///
/// `stretches` must be in the order of time and apart. NaN for one that the truth does not cover from its start to the
/// stretch's end without a gap. Throws std::invalid_argument if a sigma of the scans, their interval or the step is not
/// positive, or if the stretches overlap.
std::vector<double> posterior_bounds(const Trajectory& truth, const AxisChoice& axis,
                                     const std::vector<BlindStretch>& stretches, const BoundOptions& options);

/// Gives every stretch of a single run its bound, and beside it, unless the axis is kWeakest, the figure of
/// portal_to_portal_sigma() for the IMU's x axis, NaN else.
void add_bounds(const Trajectory& truth, const AxisChoice& axis, const BoundOptions& options,
                ConsistencySummary& summary);

}  // namespace allan_lio
