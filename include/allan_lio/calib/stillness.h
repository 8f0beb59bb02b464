// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace allan_lio {

/// Scatter of a record stretch by stretch, to find where it was not still.
class Stillness {
 public:
  static constexpr double kStretch = 10.0;  ///< [s]

  /// `period`: of the samples [s].
  explicit Stillness(double period);

  /// Gyro x y z, accelerometer x y z, in any units; `missing` samples before it were not seen.
  void add(const std::array<double, 6>& sample, std::int64_t missing);

  /// A sentence if the sensor was moved: a stretch that scatters far more than the rest, a turn, or scatter all along
  /// that no sensor at rest has. Empty if not. The readings times `units` are SI.
  std::string warning(const std::array<double, 6>& units) const;

 private:
  struct Stretch {
    std::array<float, 6> mean, deviation;
    std::int64_t begin;  // index of its first sample
  };
  void close();

  double period_;
  std::int64_t length_;  // samples
  std::int64_t count_ = 0, index_ = 0, begin_ = 0;
  std::array<double, 6> origin_{}, sum_{}, squares_{};  // of the open stretch; sums with its first sample taken off
  std::vector<Stretch> stretches_;
};

}  // namespace allan_lio
