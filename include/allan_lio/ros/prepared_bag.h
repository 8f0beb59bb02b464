// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "allan_lio/calib/prepared_record.h"
#include "allan_lio/lio/lio_config.h"

namespace allan_lio {

/// Bags, decoded and thinned for many runs.
struct PreparedBag {
  PreparedRecord record;
  /// What a user should know: the verdict on the point times, bags that are cut off, messages that could not be
  /// decoded.
  std::vector<std::string> notes;
};

/// Asked now and then while a bag is read, with the part that is read, 0 to 1; false stops it.
using GoOn = std::function<bool(double)>;

/// Reads the bags (merged by time) as lio_offline does: run 0 of a trial gives lio_offline's results to the bit.
/// `reference`: TUM file with the IMU's true poses, empty for none. Throws BagError where lio_offline would have no
/// result, for a recording that begins anew on its way (a trial is one run), and when `go_on` (may be empty) says stop;
/// std::runtime_error for a truth that cannot be read or does not belong to the bag. Both name the file.
PreparedBag prepare_bag(const std::vector<std::string>& files, const LioConfig& config, const std::string& reference,
                        const GoOn& go_on = {});

}  // namespace allan_lio
