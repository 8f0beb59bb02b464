// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "allan_lio/imu/imu_noise.h"
#include "allan_lio/imu/imu_sample.h"
#include "allan_lio/sim/imu_defects.h"
#include "allan_lio/sim/motion.h"

namespace allan_lio {

constexpr double kSimGravity = 9.80665;  ///< [m/s^2], down along the world's -z

/// Which of the specification's errors a simulated IMU has, and what others.
struct ImuErrorConfig {
  bool white = true;      ///< N_g, N_a
  bool bias_walk = true;  ///< the Gauss-Markov bias of sigma_b and T_b
  bool turn_on = true;    ///< the constant turn-on bias
  ImuDefects defects;     ///< none
};

/// The errors of one IMU at a fixed rate, sample by sample: white noise of standard deviation N sqrt(rate), and a
/// bias that is a constant N(0, turn_on^2) plus a stationary first-order Gauss-Markov process of driving noise S_b
/// and correlation time T_b, discretised exactly; without a T_b, a random walk from zero. White noise and biases have
/// generators of their own: switching one off leaves the other's values alone.
class ImuErrorModel {
 public:
  /// Throws std::invalid_argument if rate [Hz] or a bias time is not positive.
  ImuErrorModel(const NoiseSpec& spec, const ImuErrorConfig& config, double rate, std::uint64_t seed);

  struct Errors {
    Eigen::Vector3d gyro_bias, gyro_white;    ///< [rad/s]
    Eigen::Vector3d accel_bias, accel_white;  ///< [m/s^2]
  };

  /// The errors of the next sample.
  Errors next();

 private:
  struct Sensor {
    Eigen::Vector3d white_sigma, turn_on, decay, step, wandering;
    Eigen::Vector3d next_bias(std::mt19937_64& generator);
  };

  Sensor gyro_, accel_;
  std::mt19937_64 white_generator_, bias_generator_;
};

struct SimulatedImu {
  std::vector<ImuSample> samples;           ///< stamped by the IMU's clock
  std::vector<TimeNs> true_stamps;          ///< the same by the LiDAR's clock, which the truth goes by
  std::vector<Eigen::Vector3d> gyro_bias;   ///< truth, one a sample; empty if not known [rad/s]
  std::vector<Eigen::Vector3d> accel_bias;  ///< truth, one a sample; empty if not known [m/s^2]
};

/// What an accelerometer without errors reads, in the IMU frame [m/s^2].
Eigen::Vector3d specific_force(const MotionState& state);

/// Samples at start_stamp + k/rate for `duration` [s], both ends included, stamped by the IMU's clock and without those
/// that are lost if the configuration says so.
SimulatedImu simulate_imu(const Motion& trajectory, double duration, TimeNs start_stamp, double rate,
                          const NoiseSpec& spec, const ImuErrorConfig& config, std::uint64_t seed);

}  // namespace allan_lio
