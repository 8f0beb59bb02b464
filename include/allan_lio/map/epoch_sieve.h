// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {

/// Tells in one look where no voxel of an early epoch is near, so that a run whose old planes lie behind it need not
/// search for them around every point. Blocks of voxels share the cells of a table by their hash: of a cell that is
/// shared by an old one and a young one it says "perhaps", and never "no" of what is there.
class EpochSieve {
 public:
  EpochSieve() : earliest_(kCells) { clear(); }

  /// A voxel has been made in this epoch.
  void note(const VoxelCoordinates& made, std::uint32_t epoch) {
    for (int x = block(made.x - 1); x <= block(made.x + 1); ++x)
      for (int y = block(made.y - 1); y <= block(made.y + 1); ++y)
        for (int z = block(made.z - 1); z <= block(made.z + 1); ++z) {
          std::uint32_t& earliest = earliest_[cell(x, y, z)];
          earliest = std::min(earliest, epoch);
        }
  }

  /// False if neither this voxel nor one of its 26 neighbours has been made in `last_epoch` or before.
  bool may_be_near(const VoxelCoordinates& c, std::uint32_t last_epoch) const {
    return earliest_[cell(block(c.x), block(c.y), block(c.z))] <= last_epoch;
  }

  void clear() { std::fill(earliest_.begin(), earliest_.end(), std::numeric_limits<std::uint32_t>::max()); }
  static constexpr std::size_t bytes() { return kCells * sizeof(std::uint32_t); }

 private:
  static constexpr std::size_t kCells = std::size_t{1} << 15U;
  static constexpr int kBits = 2;  // a block's edge is 4 voxels

  static int block(int voxel) { return voxel >> kBits; }
  static std::size_t cell(int x, int y, int z) { return hash_key(voxel_key({x, y, z})) & (kCells - 1); }

  std::vector<std::uint32_t> earliest_;
};

}  // namespace allan_lio
