// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/lidar_simulator.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <optional>
#include <stdexcept>

#include "allan_lio/math/so3.h"
#include "allan_lio/sim/random.h"

namespace allan_lio {
namespace {

constexpr double kTwoPi = 6.28318530717958647692;

/// Random streams, apart from the IMU's generators.
enum Stream : std::uint64_t { kRangeNoise = 3, kGrazing, kDropout, kOffAxis, kMixing };

/// The pose `dt` [s] after `state`. Within a column (55 us) the terms left out are below a micrometre at 100 m.
RigidTransform pose_after(const MotionState& state, double dt) {
  return {state.T_world_imu.rotation * exp_so3(state.rate_imu * dt),
          state.T_world_imu.translation + dt * state.velocity_world + (0.5 * dt * dt) * state.acceleration_world};
}

/// In the world frame.
struct Ray {
  Eigen::Vector3d origin, direction;
};

/// The random numbers of one firing of one beam: functions of seed, stream, sweep and firing alone.
struct BeamDraws {
  std::uint64_t seed, sweep;
  std::uint64_t firing;  ///< counted within the sweep

  /// The two words of a stream.
  std::uint64_t word(Stream stream, int index) const {
    const std::uint64_t sweep_bits = hash_bits(hash_bits(seed ^ hash_bits(stream)) + sweep);
    return hash_bits(sweep_bits + 2 * firing + static_cast<std::uint64_t>(index));
  }
  double normal(Stream stream) const { return normal_from_bits(word(stream, 0), word(stream, 1)); }
  double uniform(Stream stream, int index) const { return uniform_from_bits(word(stream, index)); }
};

}  // namespace

struct LidarSimulator::Impl {
  LidarPattern pattern;
  RigidTransform T_imu_lidar;
  const Motion& trajectory;
  const RayCaster& caster;
  TimeNs start_stamp;
  std::uint64_t seed;
  mutable tbb::task_arena arena;  // execute() is not const

  TimeNs sweep_begin(int index) const { return to_ns(index / pattern.sweep_rate); }
  void scan_column(int sweep, int column, std::vector<SimPoint>& points) const;
  double mixed_range(const Ray& ray, const RayHit& hit, const BeamDraws& draws) const;
  std::optional<double> measured_range(const Ray& ray, const RayHit& hit, double cosine, const BeamDraws& draws) const;
};

/// The range that an edge within the beam makes of a hit: the axis and another ray of the beam, evenly drawn from its
/// cross-section, meet two surfaces, and the echoes melt into one between them.
double LidarSimulator::Impl::mixed_range(const Ray& ray, const RayHit& hit, const BeamDraws& draws) const {
  if (pattern.effects.mixed_pixels == 0 || draws.uniform(kMixing, 0) >= pattern.effects.mixed_pixels) return hit.range;
  const double tangent = std::tan(0.5 * pattern.effects.divergence) * std::sqrt(draws.uniform(kOffAxis, 0));
  const double angle = kTwoPi * draws.uniform(kOffAxis, 1);
  const Eigen::Vector3d side = ray.direction.unitOrthogonal(), other_side = ray.direction.cross(side);
  const Eigen::Vector3d off_axis =
      (ray.direction + tangent * (std::cos(angle) * side + std::sin(angle) * other_side)).normalized();
  const auto other = caster.cast(ray.origin, off_axis, pattern.max_range);
  if (!other) return hit.range;
  // Where the ray would meet the axis's surface: its slope alone is no edge.
  const double on_same_plane = hit.range * hit.normal.dot(ray.direction) / hit.normal.dot(off_axis);
  if (std::abs(other->range - on_same_plane) < LidarEffects::kEdgeStep) return hit.range;
  return hit.range + draws.uniform(kMixing, 1) * (other->range - hit.range);
}

/// Nothing if the return is lost.
std::optional<double> LidarSimulator::Impl::measured_range(const Ray& ray, const RayHit& hit, double cosine,
                                                           const BeamDraws& draws) const {
  const LidarEffects& effects = pattern.effects;
  if ((effects.dropout_rate > 0 || effects.dropout_range > 0) &&
      draws.uniform(kDropout, 0) >= detection_probability(effects, hit.range, cosine))
    return std::nullopt;
  double range = mixed_range(ray, hit, draws) + pattern.range_noise * draws.normal(kRangeNoise);
  if (effects.grazing > 0) {
    range += grazing_noise(effects, hit.range, cosine) * draws.normal(kGrazing);
    if (range < pattern.min_range) return std::nullopt;
  }
  return quantized_range(effects, range);
}

void LidarSimulator::Impl::scan_column(int sweep, int column, std::vector<SimPoint>& points) const {
  const double column_time = column * pattern.column_period();
  const double begin = seconds_between(0, sweep_begin(sweep));
  const MotionState state = trajectory.at(begin + column_time);
  for (std::size_t i = 0; i < pattern.beams.size(); ++i) {
    const LidarBeam& beam = pattern.beams[i];
    const double time = column_time + beam.firing_offset;
    const Eigen::Vector3d direction = beam_direction(pattern, beam, begin, time);
    const RigidTransform T_world_lidar = pose_after(state, beam.firing_offset) * T_imu_lidar;
    const Ray ray{T_world_lidar.translation, T_world_lidar.rotation * direction};
    const auto hit = caster.cast(ray.origin, ray.direction, pattern.max_range);
    if (!hit || hit->range < pattern.min_range) continue;
    const double cosine = -hit->normal.dot(ray.direction);
    const BeamDraws draws{seed, static_cast<std::uint64_t>(sweep),
                          static_cast<std::uint64_t>(column) * pattern.beams.size() + i};
    const auto range = measured_range(ray, *hit, cosine, draws);
    if (!range) continue;
    const Eigen::Vector3f point = (*range * direction).cast<float>();
    const auto intensity = static_cast<float>(intensity_of(pattern.effects, *range, cosine));
    points.push_back({point.x(), point.y(), point.z(), intensity, beam.ring, static_cast<float>(time)});
  }
}

LidarSimulator::LidarSimulator(const LidarPattern& pattern, const RigidTransform& T_imu_lidar, const Motion& trajectory,
                               const RayCaster& caster, TimeNs start_stamp, std::uint64_t seed, int threads) {
  check(pattern);
  if (threads < 1) throw std::invalid_argument("the number of threads must be 1 or more");
  impl_.reset(new Impl{pattern, T_imu_lidar, trajectory, caster, start_stamp, seed, tbb::task_arena(threads)});
}

LidarSimulator::~LidarSimulator() = default;

int LidarSimulator::sweeps_within(double duration) const {
  return static_cast<int>(std::floor(duration * impl_->pattern.sweep_rate + 1e-6));
}

SimSweep LidarSimulator::sweep(int index) const {
  std::vector<std::vector<SimPoint>> columns(impl_->pattern.columns);
  impl_->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, impl_->pattern.columns, 32),
                      [&](const tbb::blocked_range<int>& range) {
                        for (int column = range.begin(); column < range.end(); ++column) {
                          columns[column].reserve(impl_->pattern.beams.size());
                          impl_->scan_column(index, column, columns[column]);
                        }
                      });
  });
  SimSweep sweep;
  sweep.begin = impl_->start_stamp + impl_->sweep_begin(index);
  sweep.end = impl_->start_stamp + impl_->sweep_begin(index + 1);
  sweep.points.reserve(impl_->pattern.beams.size() * columns.size());
  for (const auto& column : columns) sweep.points.insert(sweep.points.end(), column.begin(), column.end());
  return sweep;
}

}  // namespace allan_lio
