// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

namespace allan_lio {

struct VoxelCoordinates {
  int x, y, z;
  bool second = false;  ///< of two surfaces in the same cube the one that was made out later
};

/// Whichever of the cube's surfaces.
inline bool in_same_cube(const VoxelCoordinates& a, const VoxelCoordinates& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

inline VoxelCoordinates voxel_of(const Eigen::Vector3d& point, double inverse_edge) {
  return {static_cast<int>(std::floor(point.x() * inverse_edge)),
          static_cast<int>(std::floor(point.y() * inverse_edge)),
          static_cast<int>(std::floor(point.z() * inverse_edge))};
}

/// 21 bits a coordinate and one for the second surface: unique within +-2^20 voxels of the origin.
inline std::uint64_t voxel_key(const VoxelCoordinates& c) {
  constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
  return ((static_cast<std::uint64_t>(c.x) & kMask) << 42) | ((static_cast<std::uint64_t>(c.y) & kMask) << 21) |
         (static_cast<std::uint64_t>(c.z) & kMask) | (static_cast<std::uint64_t>(c.second) << 63);
}

/// Finalizer of a 64-bit mix, so that neighbouring voxels spread over the table.
inline std::uint64_t hash_key(std::uint64_t key) {
  key ^= key >> 32;
  key *= 0xd6e8feb86659fd93ULL;
  key ^= key >> 32;
  return key;
}

/// Open-addressing table from voxel key to the voxel's number, numbers given by the caller.
class VoxelIndex {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  VoxelIndex() { clear(); }

  std::uint32_t find(std::uint64_t key) const {
    for (std::size_t i = hash_key(key) & mask_;; i = (i + 1) & mask_) {
      if (slots_[i].value == kNone) return kNone;
      if (slots_[i].key == key) return slots_[i].value;
    }
  }

  /// The key must not be in the table.
  void insert(std::uint64_t key, std::uint32_t value);
  void clear();
  std::size_t bytes() const { return slots_.capacity() * sizeof(Slot); }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t value = kNone;
  };
  void place(std::uint64_t key, std::uint32_t value);

  std::vector<Slot> slots_;
  std::size_t mask_ = 0;
  std::size_t size_ = 0;
};

}  // namespace allan_lio
