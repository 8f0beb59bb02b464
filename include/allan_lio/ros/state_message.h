// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/State.h>

#include "allan_lio/imu/nav_state.h"
#include "allan_lio/lio/lio_result.h"
#include "allan_lio/ros/lio_session.h"

namespace allan_lio {

/// The whole estimate as ~state publishes it.
StatePtr to_state_message(const LioResult& result, const LioSession& session);

/// The inertial part of the message.
NavState nav_state_of(const State& message);
NavMatrix nav_covariance_of(const State& message);

}  // namespace allan_lio
