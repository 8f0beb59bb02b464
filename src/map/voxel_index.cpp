// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/map/voxel_index.h"

#include <utility>

namespace allan_lio {

constexpr std::uint32_t VoxelIndex::kNone;

void VoxelIndex::place(std::uint64_t key, std::uint32_t value) {
  std::size_t i = hash_key(key) & mask_;
  while (slots_[i].value != kNone) i = (i + 1) & mask_;
  slots_[i] = {key, value};
}

void VoxelIndex::insert(std::uint64_t key, std::uint32_t value) {
  if (2 * (size_ + 1) > slots_.size()) {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    mask_ = slots_.size() - 1;
    for (const Slot& slot : old)
      if (slot.value != kNone) place(slot.key, slot.value);
  }
  place(key, value);
  ++size_;
}

void VoxelIndex::clear() {
  slots_ = std::vector<Slot>(1024);
  mask_ = slots_.size() - 1;
  size_ = 0;
}

}  // namespace allan_lio
