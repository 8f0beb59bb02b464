// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {

/// Hashed voxels in chunks that never move, under a cap of bytes. `Voxel` must be default-constructible and is
/// reset by assignment of Voxel{}; it has a member `coordinates`.
template <class Voxel>
class VoxelStore {
 public:
  VoxelStore(double edge, double max_mb)
      : edge_(edge),
        max_voxels_(std::max<std::size_t>(1, static_cast<std::size_t>(max_mb * 1e6) / kBytesPerVoxel / kChunk) *
                    kChunk) {}

  std::size_t size() const { return size_; }
  std::size_t bytes() const { return chunks_.size() * kChunk * sizeof(Voxel) + index_.bytes(); }
  double inverse_edge() const { return 1.0 / edge_; }
  Voxel& operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
  const Voxel& operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }

  /// The voxel's number, or VoxelIndex::kNone.
  std::uint32_t number_of(const VoxelCoordinates& c) const { return index_.find(voxel_key(c)); }

  const Voxel* find(const VoxelCoordinates& c) const {
    const std::uint32_t i = number_of(c);
    return i == VoxelIndex::kNone ? nullptr : &(*this)[i];
  }

  /// The voxel's number; it is made if it is not there. The store must not be full.
  std::uint32_t find_or_make(const VoxelCoordinates& c) {
    const std::uint64_t key = voxel_key(c);
    const std::uint32_t found = index_.find(key);
    if (found != VoxelIndex::kNone) return found;
    if (size_ == chunks_.size() * kChunk) chunks_.emplace_back(new Voxel[kChunk]);
    (*this)[size_] = Voxel{};
    (*this)[size_].coordinates = c;
    index_.insert(key, static_cast<std::uint32_t>(size_));
    return static_cast<std::uint32_t>(size_++);
  }

  /// True if the voxels that one point may need do not fit any more.
  bool is_full() const { return size_ + kMostPerPoint > max_voxels_; }

  /// Forgets the voxels beyond `radius` of `center`, and then the farthest until a fifth is free.
  /// The voxels' numbers change: returns which ones are left, ascending, by the numbers that they had.
  std::vector<std::uint32_t> make_room(const Eigen::Vector3d& center, double radius) {
    std::vector<std::pair<double, std::uint32_t>> by_distance(size_);
    for (std::size_t i = 0; i < size_; ++i)
      by_distance[i] = {(voxel_center((*this)[i].coordinates) - center).squaredNorm(), static_cast<std::uint32_t>(i)};
    std::sort(by_distance.begin(), by_distance.end());
    const auto beyond = std::upper_bound(by_distance.begin(), by_distance.end(), std::make_pair(radius * radius, ~0U));
    const std::size_t inside = static_cast<std::size_t>(beyond - by_distance.begin());
    by_distance.resize(std::min(inside, max_voxels_ - max_voxels_ / 5));
    std::vector<std::uint32_t> kept;
    kept.reserve(by_distance.size());
    for (const auto& entry : by_distance) kept.push_back(entry.second);
    std::sort(kept.begin(), kept.end());
    compact(kept);
    return kept;
  }

  void clear() { compact({}); }

  Eigen::Vector3d voxel_center(const VoxelCoordinates& c) const {
    return edge_ * Eigen::Vector3d(c.x + 0.5, c.y + 0.5, c.z + 0.5);
  }

 private:
  static constexpr std::size_t kChunk = 1024;
  static constexpr std::size_t kMostPerPoint = 16;
  // A slot of the table is 16 bytes and the table at most four times the voxels; the owner may keep 8 bytes a voxel.
  static constexpr std::size_t kBytesPerVoxel = sizeof(Voxel) + 4 * 16 + 8;

  /// Keeps the voxels of these numbers, in order.
  void compact(const std::vector<std::uint32_t>& kept) {
    index_.clear();
    for (std::size_t i = 0; i < kept.size(); ++i) {
      if (kept[i] != i) (*this)[i] = std::move((*this)[kept[i]]);
      index_.insert(voxel_key((*this)[i].coordinates), static_cast<std::uint32_t>(i));
    }
    size_ = kept.size();
    chunks_.resize((size_ + kChunk - 1) / kChunk);
  }

  double edge_;
  std::size_t max_voxels_;
  std::size_t size_ = 0;
  std::vector<std::unique_ptr<Voxel[]>> chunks_;
  VoxelIndex index_;
};

}  // namespace allan_lio
