// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/imu_simulator.h"

#include <cmath>
#include <optional>
#include <stdexcept>

#include "allan_lio/sim/random.h"

namespace allan_lio {
namespace {

// Bias and white noise of the IMU; the LiDAR draws from a hash of its own (lidar_simulator.cpp).
constexpr std::uint32_t kWhiteStream = 1, kBiasStream = 2;

std::mt19937_64 make_generator(std::uint64_t seed, std::uint32_t stream) {
  std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32), stream};
  return std::mt19937_64(sequence);
}

Eigen::Vector3d draw_normal(std::mt19937_64& generator) {
  Eigen::Vector3d value;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t a = generator(), b = generator();
    value[axis] = normal_from_bits(a, b);
  }
  return value;
}

}  // namespace

ImuErrorModel::ImuErrorModel(const NoiseSpec& spec, const ImuErrorConfig& config, double rate, std::uint64_t seed)
    : white_generator_(make_generator(seed, kWhiteStream)), bias_generator_(make_generator(seed, kBiasStream)) {
  if (!(rate > 0)) throw std::invalid_argument("the IMU's rate must be positive");
  if (!(spec.gyro.bias_time.minCoeff() > 0 && spec.accel.bias_time.minCoeff() > 0))
    throw std::invalid_argument("the IMU's bias correlation times must be positive");
  const auto make_sensor = [&](const SensorNoise& noise) {
    Sensor sensor;
    sensor.white_sigma = (config.white ? std::sqrt(rate) : 0.0) * noise.white;
    sensor.decay = (-1.0 / (rate * noise.bias_time.array())).exp();
    sensor.turn_on = (config.turn_on ? 1.0 : 0.0) * noise.turn_on_bias.cwiseProduct(draw_normal(bias_generator_));
    // The process's own deviation, sqrt(S_b T_b/2); a random walk has none and starts at zero.
    const Eigen::Vector3d density = (config.bias_walk ? 1.0 : 0.0) * bias_psd(noise);
    const Eigen::Vector3d start = draw_normal(bias_generator_);
    for (int axis = 0; axis < 3; ++axis) {
      const bool settles = std::isfinite(noise.bias_time[axis]);
      const double sigma = settles ? std::sqrt(0.5 * (density[axis] * noise.bias_time[axis])) : 0.0;
      sensor.wandering[axis] = sigma * start[axis];
      sensor.step[axis] =
          settles ? sigma * std::sqrt(1.0 - sensor.decay[axis] * sensor.decay[axis]) : std::sqrt(density[axis] / rate);
    }
    return sensor;
  };
  gyro_ = make_sensor(spec.gyro);
  accel_ = make_sensor(spec.accel);
}

Eigen::Vector3d ImuErrorModel::Sensor::next_bias(std::mt19937_64& generator) {
  const Eigen::Vector3d bias = turn_on + wandering;
  wandering = decay.cwiseProduct(wandering) + step.cwiseProduct(draw_normal(generator));
  return bias;
}

ImuErrorModel::Errors ImuErrorModel::next() {
  Errors errors;
  errors.gyro_bias = gyro_.next_bias(bias_generator_);
  errors.accel_bias = accel_.next_bias(bias_generator_);
  errors.gyro_white = gyro_.white_sigma.cwiseProduct(draw_normal(white_generator_));
  errors.accel_white = accel_.white_sigma.cwiseProduct(draw_normal(white_generator_));
  return errors;
}

Eigen::Vector3d specific_force(const MotionState& state) {
  return state.T_world_imu.rotation.conjugate() * (state.acceleration_world + Eigen::Vector3d(0, 0, kSimGravity));
}

SimulatedImu simulate_imu(const Motion& trajectory, double duration, TimeNs start_stamp, double rate,
                          const NoiseSpec& spec, const ImuErrorConfig& config, std::uint64_t seed) {
  ImuErrorModel model(spec, config, rate, seed);
  std::optional<ImuDefectModel> defects;
  if (config.defects.any()) defects.emplace(config.defects, rate, seed);
  SimulatedImu imu;
  const auto count = static_cast<std::int64_t>(duration * rate + 1e-6) + 1;
  for (std::int64_t k = 0; k < count; ++k) {
    const TimeNs since_start = to_ns(static_cast<double>(k) / rate);
    const MotionState state = trajectory.at(seconds_between(0, since_start));
    const ImuErrorModel::Errors errors = model.next();
    ImuDefectModel::Reading reading{state.rate_imu, specific_force(state)};
    if (defects) reading = defects->feel(reading);
    reading = {reading.gyro + errors.gyro_bias + errors.gyro_white,
               reading.accel + errors.accel_bias + errors.accel_white};
    if (defects) reading = defects->digitize(reading);
    const std::optional<TimeNs> stamp = defects ? defects->stamp(since_start) : since_start;
    if (!stamp) continue;
    imu.samples.push_back({start_stamp + *stamp, reading.gyro, reading.accel});
    imu.true_stamps.push_back(start_stamp + since_start);
    imu.gyro_bias.push_back(errors.gyro_bias);
    imu.accel_bias.push_back(errors.accel_bias);
  }
  return imu;
}

}  // namespace allan_lio
