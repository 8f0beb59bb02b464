// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {

/// Tells in one look where no plane of an early epoch is near, so that a run whose old planes lie behind it need not
/// search for them around every point. Blocks of voxels share the cells of a table by their hash: of a cell that is
/// shared by an old one and a young one it says "perhaps", and never "no" of what is there.
///
/// A plane's epoch is the mean of its points', so it grows when they become more. To follow, a second table is filled
/// bit by bit, by renew() for every plane, and takes the first one's place.
class EpochSieve {
 public:
  EpochSieve() : earliest_(kCells), next_(kCells) { clear(); }

  /// This voxel has a plane from now on.
  void note(const VoxelCoordinates& c, std::uint32_t epoch) {
    note_in(earliest_, c, epoch);
    note_in(next_, c, epoch);
  }

  /// False if neither this voxel nor one of its 26 neighbours has a plane of `last_epoch` or before.
  bool may_be_near(const VoxelCoordinates& c, std::uint32_t last_epoch) const {
    return earliest_[cell(block(c.x), block(c.y), block(c.z))] <= last_epoch;
  }

  /// This voxel's plane is of this epoch by now.
  void renew(const VoxelCoordinates& c, std::uint32_t epoch) { note_in(next_, c, epoch); }

  /// Every plane has been renewed, or noted, since the last call.
  void finish_renewal() {
    earliest_.swap(next_);
    forget(next_);
  }

  void clear() {
    forget(earliest_);
    forget(next_);
  }

  static constexpr std::size_t bytes() { return 2 * kCells * sizeof(std::uint32_t); }

 private:
  static constexpr std::size_t kCells = std::size_t{1} << 14U;
  static constexpr std::uint32_t kNever = std::numeric_limits<std::uint32_t>::max();
  static constexpr int kBits = 2;  // a block's edge is 4 voxels

  static int block(int voxel) { return voxel >> kBits; }
  static std::size_t cell(int x, int y, int z) { return hash_key(voxel_key({x, y, z})) & (kCells - 1); }

  static void forget(std::vector<std::uint32_t>& table) { std::fill(table.begin(), table.end(), kNever); }

  static void note_in(std::vector<std::uint32_t>& table, const VoxelCoordinates& c, std::uint32_t epoch) {
    for (int x = block(c.x - 1); x <= block(c.x + 1); ++x)
      for (int y = block(c.y - 1); y <= block(c.y + 1); ++y)
        for (int z = block(c.z - 1); z <= block(c.z + 1); ++z) {
          std::uint32_t& earliest = table[cell(x, y, z)];
          earliest = std::min(earliest, epoch);
        }
  }

  std::vector<std::uint32_t> earliest_, next_;
};

}  // namespace allan_lio
