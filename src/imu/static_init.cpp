// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/imu/static_init.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "allan_lio/math/s2.h"

namespace allan_lio {
namespace {

struct Mean {
  Eigen::Vector3d gyro = Eigen::Vector3d::Zero();
  Eigen::Vector3d accel = Eigen::Vector3d::Zero();
};

Mean mean_of(const std::vector<ImuSample>& record) {
  Mean mean;
  for (const ImuSample& s : record) {
    mean.gyro += s.gyro;
    mean.accel += s.accel;
  }
  mean.gyro /= static_cast<double>(record.size());
  mean.accel /= static_cast<double>(record.size());
  return mean;
}

/// The rotation that takes the measured specific force to +z and leaves the x axis' heading at zero.
Eigen::Quaterniond level(const Eigen::Vector3d& specific_force) {
  const Eigen::Quaterniond tilt = Eigen::Quaterniond::FromTwoVectors(specific_force, Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d x = tilt * Eigen::Vector3d::UnitX();
  const bool x_is_vertical = x.head<2>().norm() < 1e-3;
  const double heading = x_is_vertical ? 0.0 : std::atan2(x.y(), x.x());
  return (Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * tilt).normalized();
}

}  // namespace

bool is_still(const std::vector<ImuSample>& record, const NoiseSpec& spec, const InitOptions& options) {
  constexpr double kMostSigma = 10.0;  // a specification may be optimistic; a rotation or a push is far beyond it
  const Mean mean = mean_of(record);
  const Eigen::Array3d gyro_sigma = spec.gyro.turn_on_bias + bias_spread(spec.gyro);
  const Eigen::Array3d accel_sigma = spec.accel.turn_on_bias + bias_spread(spec.accel);
  const double seconds = seconds_between(record.front().stamp, record.back().stamp);
  const Eigen::Array3d gyro_noise = spec.gyro.white.array() / std::sqrt(seconds);
  if ((mean.gyro.array().abs() > kMostSigma * (gyro_sigma + gyro_noise)).any()) return false;
  const double accel_noise = spec.accel.white.maxCoeff() / std::sqrt(seconds);
  if (std::abs(mean.accel.norm() - options.gravity) > kMostSigma * (accel_sigma.maxCoeff() + accel_noise)) return false;
  Eigen::Array3d gyro = Eigen::Array3d::Zero(), accel = Eigen::Array3d::Zero();
  for (const ImuSample& s : record) {
    gyro += (s.gyro - mean.gyro).array().square();
    accel += (s.accel - mean.accel).array().square();
  }
  const double n = static_cast<double>(record.size());
  return (gyro / n).sqrt().maxCoeff() < options.gyro_still && (accel / n).sqrt().maxCoeff() < options.accel_still;
}

double detect_accel_scale(const std::vector<ImuSample>& record, double gravity) {
  std::vector<double> lengths;
  lengths.reserve(record.size());
  for (const ImuSample& s : record) lengths.push_back(s.accel.norm());
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle < std::sqrt(gravity) ? gravity : 1.0;  // the geometric middle of 1 g and 9.8 m/s^2
}

InitialState initialize(const std::vector<ImuSample>& record, bool still, const NoiseSpec& spec, const ImuNoise& noise,
                        const InitOptions& options) {
  const Mean mean = mean_of(record);
  const double length = seconds_between(record.front().stamp, record.back().stamp);
  InitialState out;
  out.state.stamp = record.front().stamp;
  out.state.T_world_imu.rotation = level(mean.accel);
  out.state.gravity_world = Eigen::Vector3d(0, 0, -options.gravity);

  out.covariance.setZero();
  out.covariance.diagonal().segment<3>(kVelocity).setConstant(options.velocity_sigma * options.velocity_sigma);
  auto gyro_variance = out.covariance.diagonal().segment<3>(kGyroBias);
  if (still) {
    out.state.gyro_bias = mean.gyro;
    gyro_variance = noise.gyro_psd / length + noise.gyro_bias_psd * length / 3.0;
  } else {
    gyro_variance = spec.gyro.turn_on_bias.array().square() + bias_spread(spec.gyro).array().square();
  }

  // Accelerometer bias and gravity direction: one Kalman step on f = ba - R^T g + noise.
  using Joint = Eigen::Matrix<double, 5, 5>;
  const double kAnyTilt = 1.0;  // [rad] of the gravity direction before the measurement
  Joint prior = Joint::Zero();
  prior.diagonal() << (spec.accel.turn_on_bias.array().square() + bias_spread(spec.accel).array().square()), kAnyTilt,
      kAnyTilt;
  const Eigen::Matrix3d back = out.state.T_world_imu.rotation.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 3, 5> h;
  h << Eigen::Matrix3d::Identity(), -back * s2_plus_jacobian(out.state.gravity_world);
  Eigen::Matrix3d measurement_noise = (noise.accel_psd / length).asDiagonal();
  if (!still) measurement_noise.diagonal().array() += options.moving_accel_sigma * options.moving_accel_sigma;
  const Eigen::Matrix3d innovation = h * prior * h.transpose() + measurement_noise;
  const Eigen::Matrix<double, 5, 3> gain = prior * h.transpose() * innovation.inverse();
  const Eigen::Matrix<double, 5, 1> step = gain * (mean.accel + back * out.state.gravity_world);
  const Joint left = Joint::Identity() - gain * h;
  const Joint joint = left * prior * left.transpose() + gain * measurement_noise * gain.transpose();
  out.state.accel_bias = step.head<3>();
  out.state.gravity_world = s2_plus(out.state.gravity_world, step.tail<2>());
  out.covariance.block<5, 5>(kAccelBias, kAccelBias) = joint;  // gravity follows the bias in the order of NavIndex
  return out;
}

}  // namespace allan_lio
