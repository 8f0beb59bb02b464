// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// Keeps the first point of every voxel. Holds its table between calls, so that it does not allocate.
class VoxelDownsampler {
 public:
  /// Of the points `candidates` (indices into `points`; all of them if null) those that are first in their cube of
  /// edge `leaf` [m], in order. Coordinates must be finite and below 1e5 leaves.
  void select(const std::vector<ScanPoint>& points, const std::vector<std::uint32_t>* candidates, double leaf,
              std::vector<std::uint32_t>& kept);

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t epoch = 0;
  };
  bool insert(std::uint64_t key);

  std::vector<Slot> table_;
  std::uint32_t epoch_ = 0;
};

}  // namespace allan_lio
