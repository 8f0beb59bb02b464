// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace allan_lio {

/// The path of another program of this package, which lies beside the running one. Throws std::runtime_error if it is
/// not there.
std::string sibling_program(const std::string& name);

/// The path of one of the package's scripts: beside the running program, where an installation has it, or in the
/// package's source tree (found by way of ROS_PACKAGE_PATH). Throws std::runtime_error if it is at neither place.
std::string package_script(const std::string& name);

}  // namespace allan_lio
