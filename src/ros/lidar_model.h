// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "allan_lio/ros/bag_reader.h"

namespace allan_lio {

/// The file of config/ that fits a cloud of this topic best ("lidar/ouster"), by its type, fields and rings. A guess
/// where drivers lay out their clouds alike.
std::string guess_lidar_model(const BagMessage& cloud);

}  // namespace allan_lio
