// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/scan_downsample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {
namespace {

constexpr int kCellOffset = 1 << 17;     // makes every cell's number positive: 18 bits a coordinate
constexpr float kMostCells = 130000.0F;  // from the middle of a cube's face to its edge
constexpr int kShellOffset = 64;
constexpr float kCellsPerLeaf = 1.5F;  // at the inner edge of a shell; at the outer one half of it
constexpr float kNearBorder = 0.1F;    // [m] of a shell's border: several sigma of the range noise

float largest_of(const ScanPoint& p) { return std::max(std::max(std::abs(p.x), std::abs(p.y)), std::abs(p.z)); }

/// floor(log2(x)) of a normal positive number.
int exponent_of(float x) {
  std::uint32_t bits;
  std::memcpy(&bits, &x, sizeof(bits));
  return static_cast<int>(bits >> 23) - 127;
}

/// 2^exponent.
float power_of_two(int exponent) {
  const std::uint32_t bits = static_cast<std::uint32_t>(exponent + 127) << 23;
  float x;
  std::memcpy(&x, &bits, sizeof(x));
  return x;
}

/// The cell of a point: its direction, projected onto a cube, in steps of about a leaf at the range of the shell.
/// A shell spans a factor of two in range (the largest coordinate stands for it).
std::uint64_t beam_cell(const ScanPoint& p, float largest, int shell, float cells_per_metre) {
  const float to_cells = std::min(std::ceil(cells_per_metre * power_of_two(shell)), kMostCells) / largest;
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
      if (4 * ++used_ > 3 * table_.size()) grow();
      return true;
    }
    if (slot.key == key) return false;
  }
}

void ScanDownsampler::grow() {
  std::vector<Slot> old(2 * table_.size());
  old.swap(table_);
  used_ = 0;
  for (const Slot& slot : old)
    if (slot.epoch == epoch_) insert(slot.key);
}

void ScanDownsampler::select(const std::vector<ScanPoint>& points, const std::vector<std::uint32_t>* candidates,
                             double leaf, std::vector<std::uint32_t>& kept) {
  const std::size_t count = candidates ? candidates->size() : points.size();
  if (table_.empty()) table_.resize(1024);
  if (++epoch_ == 0) {
    table_.assign(table_.size(), Slot{});
    epoch_ = 1;
  }
  used_ = 0;
  kept.clear();
  const float cells_per_metre = kCellsPerLeaf / static_cast<float>(leaf);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = candidates ? (*candidates)[i] : static_cast<std::uint32_t>(i);
    const ScanPoint& p = points[index];
    const float largest = largest_of(p);
    const int shell = exponent_of(largest);
    bool is_first = insert(beam_cell(p, largest, shell, cells_per_metre));
    // Near a border it is the noise that chooses the shell, so the point has to be first on either side of it.
    const float inner = power_of_two(shell);
    if (largest - inner < kNearBorder) is_first &= insert(beam_cell(p, largest, shell - 1, cells_per_metre));
    if (2.0F * inner - largest < kNearBorder) is_first &= insert(beam_cell(p, largest, shell + 1, cells_per_metre));
    if (is_first) kept.push_back(index);
  }
}

}  // namespace allan_lio
