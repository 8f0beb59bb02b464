// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "allan_lio/lidar/scan.h"
#include "allan_lio/lidar/scan_downsample.h"

namespace allan_lio {

/// In what the repeated runs of a recording differ, as runs of a live system do: when the filter was started, which
/// points the thinning chose, and what was lost on the way. Drawn from (seed, recording, run) alone, so that all
/// settings are held against the same runs. Run 0 is the recording as it is.
class RunPerturbation {
 public:
  static constexpr double kLatestStart = 1.0;    ///< [s] after the first scan
  static constexpr double kLostSamples = 1e-3;   ///< share of the IMU's samples
  static constexpr double kLostScans = 2e-3;     ///< share of the scans
  static constexpr double kLostPackets = 1e-2;   ///< share of the packets of a scan
  static constexpr std::uint32_t kPackets = 64;  ///< a sweep has; a 16-beam LiDAR at 10 Hz sends 75

  /// `recording`: its digest.
  RunPerturbation(std::uint64_t seed, std::uint64_t recording, std::uint32_t run);

  bool keeps_sample(std::size_t index) const;

  /// `since_first`: from the first scan's begin to this one's [s].
  bool keeps_scan(std::size_t index, double since_first) const;

  /// Takes the lost packets out of a thinned scan and chooses its points for the update anew, one a cell of `leaf` [m].
  void apply(std::size_t index, double leaf, ScanDownsampler& downsampler, Scan& scan) const;

 private:
  /// Uniform in [0, 1), for the `index`-th thing of a kind.
  double draw(std::uint64_t kind, std::uint64_t index) const;

  bool as_it_is_;
  std::uint64_t state_;
  double start_;         ///< [s] after the first scan
  std::uint32_t phase_;  ///< of the thinning
};

}  // namespace allan_lio
