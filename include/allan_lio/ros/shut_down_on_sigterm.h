// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace allan_lio {

/// Has SIGTERM shut the process's ROS down in order, as roscpp has SIGINT do; by default it would end the process in
/// the middle of a line of its results. Leaves a handler of somebody else alone. Call it after ros::init().
void shut_down_on_sigterm();

}  // namespace allan_lio
