// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/scan_downsample.h"

#include <algorithm>
#include <cmath>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {
namespace {

constexpr int kCellOffset = 1 << 17;  // makes every cell's number positive: 18 bits a coordinate
constexpr int kShellOffset = 64;
constexpr float kCellsPerLeaf = 1.5F;  // at the inner edge of a shell; at the outer one half of it

constexpr float kNearBorder = 0.1F;  // [m] of a shell's border: several sigma of the range noise

float largest_of(const ScanPoint& p) { return std::max(std::max(std::abs(p.x), std::abs(p.y)), std::abs(p.z)); }

/// The cell of a point: its direction, projected onto a cube, in steps of about a leaf at the range of the shell.
/// A shell spans a factor of two in range (the largest coordinate stands for it).
std::uint64_t beam_cell(const ScanPoint& p, float largest, int shell, float cells_per_metre) {
  const float cells = std::ceil(std::ldexp(cells_per_metre, shell));
  const float to_cells = cells / largest;
  const auto part = [&](float x) {
    return static_cast<std::uint64_t>(static_cast<int>(std::floor(x * to_cells)) + kCellOffset);
  };
  return part(p.x) | part(p.y) << 18 | part(p.z) << 36 | static_cast<std::uint64_t>(shell + kShellOffset) << 54;
}

}  // namespace

bool ScanDownsampler::insert(std::uint64_t key) {
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

void ScanDownsampler::select(const std::vector<ScanPoint>& points, const std::vector<std::uint32_t>* candidates,
                             double leaf, std::vector<std::uint32_t>& kept) {
  const std::size_t count = candidates ? candidates->size() : points.size();
  std::size_t wanted = 1024;
  while (wanted < 6 * count) wanted *= 2;  // up to three cells a point
  if (table_.size() < wanted || ++epoch_ == 0) {
    table_.assign(wanted > table_.size() ? wanted : table_.size(), Slot{});
    epoch_ = 1;
  }
  kept.clear();
  const float cells_per_metre = kCellsPerLeaf / static_cast<float>(leaf);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = candidates ? (*candidates)[i] : static_cast<std::uint32_t>(i);
    const ScanPoint& p = points[index];
    const float largest = largest_of(p);
    const int shell = std::ilogb(largest);
    bool is_first = insert(beam_cell(p, largest, shell, cells_per_metre));
    // Near a border it is the noise that chooses the shell, so the point has to be first on either side of it.
    const float inner = std::ldexp(1.0F, shell);
    if (largest - inner < kNearBorder) is_first &= insert(beam_cell(p, largest, shell - 1, cells_per_metre));
    if (2.0F * inner - largest < kNearBorder) is_first &= insert(beam_cell(p, largest, shell + 1, cells_per_metre));
    if (is_first) kept.push_back(index);
  }
}

}  // namespace allan_lio
