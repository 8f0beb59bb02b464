// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace allan_lio {

/// Where load_yaml() looks for names such as "imu/mti600": the package's config/, found by way of ROS_PACKAGE_PATH
/// (no master is needed). Empty if the package is not on that path; files given by path load all the same.
std::vector<std::string> config_search_dirs();

}  // namespace allan_lio
