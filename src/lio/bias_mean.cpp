// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/bias_mean.h"

namespace allan_lio {
namespace {

static_assert(kAccelBias == kGyroBias + 3 && kAccelBiasMean == kGyroBiasMean + 3, "the biases lie side by side");
using Biases = Eigen::Matrix<double, 6, 1>;

double square(double x) { return x * x; }

/// What of the means' errors the biases take on.
Biases taken_on(const NavMatrix& transition) { return Biases::Ones() - transition.diagonal().segment<6>(kGyroBias); }

/// Regression of the constant part on the sum of both.
struct Split {
  double gain = 0.0;
  double rest = 0.0;  ///< variance of the constant part if the sum is known
};

Split split(double turn_on, double psd, double rate) {
  if (!(rate > 0.0)) return {};
  const double constant = square(turn_on), wander = psd / (2.0 * rate), sum = constant + wander;
  if (!(sum > 0.0)) return {};
  return {constant / sum, constant * wander / sum};
}

}  // namespace

InertialVector inertial_minus(const NavState& y, const NavState& x) {
  InertialVector delta;
  delta << nav_minus(y, x), y.gyro_bias_mean - x.gyro_bias_mean, y.accel_bias_mean - x.accel_bias_mean;
  return delta;
}

InertialMatrix with_bias_means(const NavMatrix& transition) {
  InertialMatrix out = InertialMatrix::Identity();
  out.topLeftCorner<kNavDof, kNavDof>() = transition;
  out.block<6, 6>(kGyroBias, kGyroBiasMean).diagonal() = taken_on(transition);
  return out;
}

void carry(const NavMatrix& transition, InertialVector& error) {
  const NavVector carried = transition * error.head<kNavDof>();
  error.head<kNavDof>() = carried;
  error.segment<6>(kGyroBias) += taken_on(transition).cwiseProduct(error.segment<6>(kGyroBiasMean));
}

void carry(const NavMatrix& transition, InertialMatrix& covariance) {
  const Biases means = taken_on(transition);
  Eigen::Matrix<double, kNavDof, kInertialDof> rows = transition * covariance.topRows<kNavDof>();
  rows.middleRows<6>(kGyroBias) += means.asDiagonal() * covariance.bottomRows<6>();
  NavMatrix nav = rows.leftCols<kNavDof>() * transition.transpose();
  nav.middleCols<6>(kGyroBias) += rows.rightCols<6>() * means.asDiagonal();
  covariance.topLeftCorner<kNavDof, kNavDof>() = 0.5 * (nav + nav.transpose());
  covariance.topRightCorner<kNavDof, 6>() = rows.rightCols<6>();
  covariance.bottomLeftCorner<6, kNavDof>() = rows.rightCols<6>().transpose();
}

void split_biases(const NoiseSpec& spec, const ImuNoise& noise, NavState& state, InertialMatrix& covariance) {
  Biases gain, rest;
  for (int axis = 0; axis < 3; ++axis) {
    const Split gyro = split(spec.gyro.turn_on_bias[axis], noise.gyro_bias_psd[axis], noise.gyro_bias_rate[axis]);
    const Split accel = split(spec.accel.turn_on_bias[axis], noise.accel_bias_psd[axis], noise.accel_bias_rate[axis]);
    gain[axis] = gyro.gain, gain[3 + axis] = accel.gain;
    rest[axis] = gyro.rest, rest[3 + axis] = accel.rest;
  }
  state.gyro_bias_mean += gain.head<3>().cwiseProduct(state.gyro_bias - state.gyro_bias_mean);
  state.accel_bias_mean += gain.tail<3>().cwiseProduct(state.accel_bias - state.accel_bias_mean);
  const Eigen::Matrix<double, 6, kNavDof> rows =
      gain.asDiagonal() * covariance.middleRows<6>(kGyroBias).leftCols<kNavDof>();
  covariance.bottomLeftCorner<6, kNavDof>() = rows;
  covariance.topRightCorner<kNavDof, 6>() = rows.transpose();
  covariance.bottomRightCorner<6, 6>() = rows.middleCols<6>(kGyroBias) * gain.asDiagonal();
  covariance.bottomRightCorner<6, 6>().diagonal() += rest;
}

}  // namespace allan_lio
