// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "allan_lio/eval/consistency.h"
#include "allan_lio/eval/dead_reckoning.h"

namespace allan_lio {

/// What the IMU alone allows through a blind stretch, beside what happened.
struct BoundOptions {
  AxialNoise noise;               ///< of the IMU's axis along the stretch
  double position_sigma = 0.002;  ///< of a scan's position along the axis before the stretch [m]
  double interval = 0.1;          ///< between scans [s]
};

/// A table in plain text, and a JSON object in one line.
std::string consistency_table(const ConsistencySummary& summary, const std::optional<BoundOptions>& bound);
std::string consistency_json(const ConsistencySummary& summary, const std::optional<BoundOptions>& bound);

/// One line a scan: errors, sigmas and NEES, for plots and for averages over runs. Throws std::runtime_error naming the
/// path if it cannot be written.
void write_consistency_csv(const std::string& path, const ConsistencySeries& series);

/// Of such a file, what averages over runs need: columns t, support, e_along, s_along, nees_* and dof_innovation; the
/// rest may be missing. Throws std::runtime_error "file:line: sentence".
ConsistencySeries read_consistency_csv(const std::string& path);

}  // namespace allan_lio
