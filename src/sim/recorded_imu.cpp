// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/sim/recorded_imu.h"

#include <algorithm>
#include <stdexcept>

#include "allan_lio/imu/noise_units.h"
#include "allan_lio/io/imu_csv.h"
#include "allan_lio/io/number_text.h"

namespace allan_lio {
namespace {

constexpr TimeNs kLargestGap = kNsPerSecond / 10;

double factor_of(const std::string& path, const std::string& unit, Dimension dimension) {
  if (unit.empty()) return 1.0;
  const UnitConversion conversion = convert_unit(unit, dimension);
  if (!conversion.ok()) throw std::runtime_error(path + ": " + conversion.error);
  return conversion.to_si;
}

}  // namespace

std::vector<ImuSample> read_recorded_imu(const std::string& path) {
  ImuCsvReader reader(path);
  if (!reader.has_time()) throw std::runtime_error(path + ": a recorded IMU needs a column of times");
  const double gyro = factor_of(path, reader.gyro_unit(), Dimension::kAngularRate);
  const double accel = factor_of(path, reader.accel_unit(), Dimension::kAcceleration);
  std::vector<ImuSample> record;
  for (ImuSample sample; reader.next(sample);) {
    if (!sample.gyro.allFinite() || !sample.accel.allFinite()) continue;
    if (!record.empty() && sample.stamp <= record.back().stamp)
      throw std::runtime_error(path + ": the time does not rise after sample " + std::to_string(record.size()));
    record.push_back({sample.stamp, gyro * sample.gyro, accel * sample.accel});
  }
  if (record.empty()) throw std::runtime_error(path + ": no sample of an IMU");
  return record;
}

SimulatedImu recorded_imu(const std::vector<ImuSample>& record, TimeNs begin, TimeNs end) {
  const auto seconds = [&](TimeNs stamp) { return number_text(seconds_between(begin, stamp)); };
  if (record.empty()) throw std::invalid_argument("the recorded IMU holds no sample");
  if (record.front().stamp > begin + kLargestGap || record.back().stamp < end - kLargestGap)
    throw std::invalid_argument("the recorded IMU's samples lie from " + seconds(record.front().stamp) + " s to " +
                                seconds(record.back().stamp) + " s after the trajectory's begin, and 0 s to " +
                                seconds(end) + " s are needed");
  const auto earlier = [](const ImuSample& sample, TimeNs stamp) { return sample.stamp < stamp; };
  const auto later = [](TimeNs stamp, const ImuSample& sample) { return stamp < sample.stamp; };
  auto first = std::lower_bound(record.begin(), record.end(), begin, earlier);
  if (first != record.begin() && (first == record.end() || first->stamp > begin)) --first;
  SimulatedImu imu;
  imu.samples.assign(first, std::upper_bound(first, record.end(), end, later));
  for (const ImuSample& sample : imu.samples) imu.true_stamps.push_back(sample.stamp);
  return imu;
}

}  // namespace allan_lio
