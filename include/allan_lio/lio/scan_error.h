// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// By how much a scan's points together lie beside the pose at its end, because they were taken before it and brought
/// there by a noisy gyroscope: an error n of the pose (rotation, IMU frame; translation, world). The residuals see the
/// pose less this. A scan that sees far holds its attitude to a hundredth of a milliradian; this is twice that.
///
/// With points spread evenly over the duration T the errors are theta(t) = theta(T) + int_t^T n_g, whose mean over the
/// points is theta(T) + int t/T n_g dt. It is the noise that the state's error has taken in as well: the scan measures
/// the attitude in its middle rather than at its end. (The accelerometer's adds T^3/20 of its density to the position:
/// nanometres.)
///
/// What a wrong velocity or bias shifts is not in here: the map was made with nearly the same one and lies as wrong.
struct ScanError {
  PoseMatrix noise = PoseMatrix::Zero();                                                     ///< cov(n)
  Eigen::Matrix<double, kLioDof, 6> with_state = Eigen::Matrix<double, kLioDof, 6>::Zero();  ///< cov(x, n)
};

/// `duration` of the scan [s], 0 if it was not deskewed; `gyro_psd`: density of the gyroscope's white noise
/// [(rad/s)^2/Hz].
ScanError deskewing_error(double duration, const Eigen::Vector3d& gyro_psd);

}  // namespace allan_lio
