// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/scan_downsample.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "allan_lio/map/voxel_index.h"

namespace allan_lio {
namespace {

constexpr float kCellOffset = 131072.0F;           // makes every cell's number positive: 18 bits a coordinate
constexpr float kMostCells = 130000.0F;            // from the middle of a cube's face to its edge
constexpr int kFirstShell = -20, kLastShell = 42;  // a micrometre and 4e12 m
constexpr float kCellsPerLeaf = 1.5F;              // at the inner edge of a shell; at the outer one half of it
constexpr float kLeastLargest = 1e-30F;            // [m]: its inverse is finite
constexpr float kNearBorder = 0.1F;                // [m] of a shell's border: several sigma of the range noise

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
std::uint64_t beam_cell(const ScanPoint& p, float inverse_largest, int shell, float cells_per_face) {
  const float to_cells = cells_per_face * inverse_largest;
  // The sum is positive, so that cutting its digits off rounds it down.
  const auto part = [&](float x) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(static_cast<int>(x * to_cells + kCellOffset)));
  };
  return part(p.x) | part(p.y) << 18 | part(p.z) << 36 | static_cast<std::uint64_t>(shell - kFirstShell + 1) << 54;
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
  float cells_per_face[kLastShell - kFirstShell + 3];  // from one shell below the first to one above the last
  for (int shell = kFirstShell - 1; shell <= kLastShell + 1; ++shell)
    cells_per_face[shell - kFirstShell + 1] = std::min(std::ceil(cells_per_metre * power_of_two(shell)), kMostCells);
  const auto is_first_in = [&](const ScanPoint& p, float inverse, int shell) {
    return insert(beam_cell(p, inverse, shell, cells_per_face[shell - kFirstShell + 1]));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = candidates ? (*candidates)[i] : static_cast<std::uint32_t>(i);
    const ScanPoint& p = points[index];
    const float largest = largest_of(p), inverse = 1.0F / std::max(largest, kLeastLargest);
    const int shell = std::clamp(exponent_of(largest), kFirstShell, kLastShell);
    bool is_first = is_first_in(p, inverse, shell);
    // Near a border it is the noise that chooses the shell, so the point has to be first on either side of it.
    const float inner = power_of_two(shell);
    if (largest - inner < kNearBorder) is_first &= is_first_in(p, inverse, shell - 1);
    if (2.0F * inner - largest < kNearBorder) is_first &= is_first_in(p, inverse, shell + 1);
    if (is_first) kept.push_back(index);
  }
}

}  // namespace allan_lio
