// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "allan_lio/lio/localizability.h"

namespace allan_lio {

/// Sums over what stands in the same column of the world: a square of kEdge, however high. (A pillar stands in one to
/// four of them, by where the grid falls.)
class ColumnSums {
 public:
  static constexpr double kEdge = 1.0;  ///< [m]

  /// Forgets the sums and makes room for those of so many points.
  void begin(std::size_t points) {
    columns_.clear();
    std::size_t slots = 64;
    while (slots < 2 * points) slots *= 2;
    slots_.assign(slots, kFree);
  }

  /// Adds to the column in which `place` [m] lies. At most as many places as begin() was told.
  void add(const Eigen::Vector3d& place, const PoseVector& summand) {
    const auto x = static_cast<std::int32_t>(std::floor(place.x() / kEdge));
    const auto y = static_cast<std::int32_t>(std::floor(place.y() / kEdge));
    std::size_t slot =
        (static_cast<std::uint32_t>(x) * 73856093U ^ static_cast<std::uint32_t>(y) * 19349663U) & (slots_.size() - 1);
    for (; slots_[slot] != kFree; slot = (slot + 1) & (slots_.size() - 1)) {
      Column& column = columns_[slots_[slot]];
      if (column.x != x || column.y != y) continue;
      column.sum += summand;
      return;
    }
    slots_[slot] = static_cast<std::uint32_t>(columns_.size());
    columns_.push_back({x, y, summand});
  }

  /// Sum over the columns of the squares of their sums.
  PoseVector squares() const {
    PoseVector out = PoseVector::Zero();
    for (const Column& column : columns_) out += column.sum.cwiseAbs2();
    return out;
  }

 private:
  struct Column {
    std::int32_t x, y;
    PoseVector sum;
  };
  static constexpr std::uint32_t kFree = 0xffffffffU;

  std::vector<Column> columns_;       ///< in the order in which they were met
  std::vector<std::uint32_t> slots_;  ///< hash table of their numbers; its size is a power of two
};

}  // namespace allan_lio
