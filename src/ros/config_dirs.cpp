// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/config_dirs.h"

#include <ros/package.h>

namespace allan_lio {

std::vector<std::string> config_search_dirs() {
  const std::string package = ros::package::getPath("allan_lio");
  if (package.empty()) return {};
  return {package + "/config"};
}

}  // namespace allan_lio
