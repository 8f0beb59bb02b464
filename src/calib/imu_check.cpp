// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/imu_check.h"

#include <algorithm>
#include <cmath>

#include "allan_lio/imu/imu_gate.h"
#include "allan_lio/imu/static_init.h"

namespace allan_lio {
namespace {

constexpr double kStandardGravity = 9.80665;
constexpr double kStillRate = 0.02, kStillAccel = 0.3;  // scatter of half a second at rest [rad/s], [m/s^2]
constexpr double kSameRate = 0.01, kSameAccel = 0.1;    // what its mean differs from the first half second's
constexpr double kStretch = 0.5;                        // [s]
constexpr std::size_t kPlateau = 5;                     // samples that read the very same largest value

/// Takes out what no IMU measures; how many there were.
std::size_t drop_absurd(std::vector<ImuSample>& samples, double accel_scale) {
  const std::size_t before = samples.size();
  const auto is_bad = [accel_scale](const ImuSample& s) { return !is_sane(s, accel_scale); };
  samples.erase(std::remove_if(samples.begin(), samples.end(), is_bad), samples.end());
  return before - samples.size();
}

struct Scatter {
  Eigen::Array3d mean = Eigen::Array3d::Zero(), deviation = Eigen::Array3d::Zero();
};

template <class Of>
Scatter scatter(const ImuSample* begin, const ImuSample* end, Of of) {
  Scatter s;
  const auto n = static_cast<double>(end - begin);
  for (const ImuSample* i = begin; i != end; ++i) s.mean += of(*i).array() / n;
  for (const ImuSample* i = begin; i != end; ++i) s.deviation += (of(*i).array() - s.mean).square() / n;
  s.deviation = s.deviation.sqrt();
  return s;
}

const Eigen::Vector3d& gyro_of(const ImuSample& s) { return s.gyro; }
const Eigen::Vector3d& accel_of(const ImuSample& s) { return s.accel; }

/// How many samples from the first one on are of a sensor at rest.
std::size_t still_samples(const std::vector<ImuSample>& samples) {
  Scatter first_gyro, first_accel;
  std::size_t begin = 0;
  for (std::size_t end = 0; end < samples.size(); ++end) {
    if (seconds_between(samples[begin].stamp, samples[end].stamp) < kStretch) continue;
    const Scatter gyro = scatter(&samples[begin], &samples[end], gyro_of);
    const Scatter accel = scatter(&samples[begin], &samples[end], accel_of);
    if (begin == 0) first_gyro = gyro, first_accel = accel;
    const bool still = (gyro.deviation < kStillRate).all() && (accel.deviation < kStillAccel).all() &&
                       ((gyro.mean - first_gyro.mean).abs() < kSameRate).all() &&
                       ((accel.mean - first_accel.mean).abs() < kSameAccel).all();
    if (!still) return begin;
    begin = end;
  }
  return begin;
}

/// Density of the white noise that makes steps between neighbours scatter so; drift hardly enters.
template <class Of>
double white_noise(const std::vector<ImuSample>& samples, std::size_t count, double interval, Of of) {
  Eigen::Array3d sum = Eigen::Array3d::Zero();
  for (std::size_t i = 1; i < count; ++i) sum += (of(samples[i]) - of(samples[i - 1])).array().square();
  return std::sqrt(sum.maxCoeff() / (2.0 * static_cast<double>(count - 1)) * interval);
}

template <class Of>
Clipping find_clipping(const std::vector<ImuSample>& samples, double largest, Of of) {
  Clipping clipping;
  std::size_t others = 0;
  for (const ImuSample& s : samples) {
    clipping.samples += static_cast<std::size_t>((of(s).array().abs() == largest).count());
    others += (of(s).array().abs() < 0.5 * largest).all() ? 1U : 0U;
  }
  // A sensor at rest, or one of few bits, reads its largest value often too.
  if (clipping.samples < kPlateau || others < samples.size() / 2) return {};
  clipping.at = largest;
  return clipping;
}

void take_standstill(const std::vector<ImuSample>& samples, ImuReport& report) {
  const std::size_t still = still_samples(samples);
  const std::size_t count = still > 1 ? still : samples.size();
  report.standstill = still > 1 ? seconds_between(samples.front().stamp, samples[still - 1].stamp) : 0.0;
  for (std::size_t i = 0; i < count; ++i) report.gravity += samples[i].accel.norm() / static_cast<double>(count);
  if (report.standstill < ImuReport::kEnoughStandstill) return;
  const double interval = report.standstill / static_cast<double>(still - 1);
  report.gyro_bias = scatter(&samples[0], &samples[still], gyro_of).mean;
  report.gyro_noise = white_noise(samples, still, interval, gyro_of);
  report.accel_noise = white_noise(samples, still, interval, accel_of);
}

}  // namespace

ImuReport check_imu(std::vector<ImuSample> samples) {
  ImuReport report;
  report.invalid = drop_absurd(samples, 1.0);
  if (samples.empty()) return report;
  const double scale = detect_accel_scale(samples, kStandardGravity);
  report.in_g = scale != 1.0;
  report.invalid += drop_absurd(samples, scale);  // leaves more than half: the median is short
  for (ImuSample& s : samples) {
    s.accel *= scale;
    report.largest_rate = std::max(report.largest_rate, s.gyro.cwiseAbs().maxCoeff());
    report.largest_accel = std::max(report.largest_accel, s.accel.cwiseAbs().maxCoeff());
  }
  const auto same = [&](const ImuSample& s) { return s.gyro == samples[0].gyro && s.accel == samples[0].accel; };
  report.frozen = samples.size() > 1 && std::all_of(samples.begin(), samples.end(), same);
  take_standstill(samples, report);
  if (report.frozen) return report;
  report.gyro_clipping = find_clipping(samples, report.largest_rate, gyro_of);
  report.accel_clipping = find_clipping(samples, report.largest_accel, accel_of);
  return report;
}

}  // namespace allan_lio
