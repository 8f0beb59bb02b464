// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lio/view_error.h"

namespace allan_lio {

void ViewError::change(double keep, const PoseMatrix& noise) {
  cross *= keep;
  own = keep * keep * own + (1.0 - keep * keep) * noise;
}

}  // namespace allan_lio
