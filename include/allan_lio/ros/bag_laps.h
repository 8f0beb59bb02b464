// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "allan_lio/math/time.h"
#include "allan_lio/ros/bag_source.h"

namespace allan_lio {

/// Bags played several times over, as one recording that goes on: from the second lap on, recording times and the
/// stamps of messages that begin with a header are later by what the laps before took. Meant for a recording that ends
/// where it began, at rest, and whose points' times count from the header's stamp.
class BagLaps {
 public:
  /// Throws BagError.
  BagLaps(const std::vector<std::string>& files, std::uint64_t laps);

  /// The topic whose stamps tell what a lap takes: from the first to the last, and one mean interval more. Needed
  /// before the first next() if there is more than one lap.
  void measure_by(const std::string& topic) { measured_ = topic; }

  /// The bags of the present lap.
  const BagSource& bags() const { return *bags_; }

  /// False at the end of the last lap, or of the first one of a bag that is not whole. Throws BagError if no second lap
  /// can follow the first one.
  bool next(BagMessage& message);

 private:
  bool has_header(const BagConnection& connection);
  void measure(const BagMessage& message);
  void begin_lap();
  void shift(BagMessage& message);

  std::vector<std::string> files_;
  std::unique_ptr<BagSource> bags_;
  std::uint64_t laps_, lap_ = 0;
  std::string measured_;
  std::map<std::string, bool> headers_;  ///< by datatype
  ros::Time first_, last_;               ///< stamps of the measured topic
  std::int64_t count_ = 0;
  TimeNs period_ = 0;  ///< of a lap
};

}  // namespace allan_lio
