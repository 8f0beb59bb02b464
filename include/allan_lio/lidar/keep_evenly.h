// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "allan_lio/lidar/scan.h"

namespace allan_lio {

/// Leaves at most `most` of the indices `kept` into `points`, in their ascending order: of the scan in the order of
/// time cut into so many parts of equally many points, one each. Fewer than `most` stay as they are. Allocates nothing.
void keep_evenly(const std::vector<ScanPoint>& points, std::size_t most, std::vector<std::uint32_t>& kept);

}  // namespace allan_lio
