// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <allan_lio/Status.h>

#include "allan_lio/lio/health.h"
#include "allan_lio/ros/lio_session.h"

namespace allan_lio {

/// The scan's ~status, but for what the judgement adds: level and message. `delay` [s].
StatusPtr to_status_message(const LioResult& result, const LioSession& session, const HealthWindow& window,
                            const LostOnTheWay& lost, double delay);

}  // namespace allan_lio
