// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/keep_evenly.h"

#include <algorithm>

#include "allan_lio/math/random_bits.h"

namespace allan_lio {

void keep_evenly(const std::vector<ScanPoint>& points, std::size_t most, std::vector<std::uint32_t>& kept) {
  const std::size_t count = kept.size();
  if (count <= most) return;
  std::sort(kept.begin(), kept.end(), [&points](std::uint32_t a, std::uint32_t b) {
    const std::int32_t time_a = points[a].offset_ns, time_b = points[b].offset_ns;
    return time_a != time_b ? time_a < time_b : a < b;
  });
  for (std::size_t part = 0; part < most; ++part) {
    // Any point of the part, the same in every run: in steps of one length it might be the same beam in every part.
    const std::size_t begin = part * count / most, end = (part + 1) * count / most;
    kept[part] = kept[begin + hash_bits(part) % (end - begin)];
  }
  kept.resize(most);
  std::sort(kept.begin(), kept.end());
}

}  // namespace allan_lio
