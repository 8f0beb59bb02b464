// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/voxel_downsample.h"

#include <cmath>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {

bool VoxelDownsampler::insert(std::uint64_t key) {
  const std::size_t mask = table_.size() - 1;
  for (std::size_t i = hash_key(key) & mask;; i = (i + 1) & mask) {
    Slot& slot = table_[i];
    if (slot.epoch != epoch_) {
      slot = {key, epoch_};
      return true;
    }
    if (slot.key == key) return false;
  }
}

void VoxelDownsampler::select(const std::vector<ScanPoint>& points, const std::vector<std::uint32_t>* candidates,
                              double leaf, std::vector<std::uint32_t>& kept) {
  const std::size_t count = candidates ? candidates->size() : points.size();
  std::size_t wanted = 1024;
  while (wanted < 2 * count) wanted *= 2;
  if (table_.size() < wanted || ++epoch_ == 0) {
    table_.assign(wanted > table_.size() ? wanted : table_.size(), Slot{});
    epoch_ = 1;
  }
  kept.clear();
  const float scale = static_cast<float>(1.0 / leaf);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = candidates ? (*candidates)[i] : static_cast<std::uint32_t>(i);
    const ScanPoint& p = points[index];
    const VoxelCoordinates c{static_cast<int>(std::floor(p.x * scale)), static_cast<int>(std::floor(p.y * scale)),
                             static_cast<int>(std::floor(p.z * scale))};
    if (insert(voxel_key(c))) kept.push_back(index);
  }
}

}  // namespace allan_lio
