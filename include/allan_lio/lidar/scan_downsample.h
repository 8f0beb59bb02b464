// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// Thins a scan by the directions of its beams, and not by cubes in space. A cube that only just reaches behind a wall
/// holds none but the points that noise has carried there, and keeping one point of every cube keeps just those:
/// registration is then off by millimetres, always to the same side as long as the cubes lie as they do
/// (doc/decisions.md, 7).
class ScanDownsampler {
 public:
  /// Of the points `candidates` (indices into `points`; all of them if null) those that are first in their cell of
  /// direction, in order; the cells are a leaf [m] wide at the middle of their shell of range. A cell is never
  /// narrower than 1/130000 of the shell's range. Coordinates must be finite and not all zero.
  void select(const std::vector<ScanPoint>& points, const std::vector<std::uint32_t>* candidates, double leaf,
              std::vector<std::uint32_t>& kept);

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t epoch = 0;
  };
  bool insert(std::uint64_t key);
  void grow();

  std::vector<Slot> table_;  ///< a power of two, as large as the scans so far needed: it stays in the cache
  std::size_t used_ = 0;     ///< slots of this epoch
  std::uint32_t epoch_ = 0;
};

}  // namespace allan_lio
