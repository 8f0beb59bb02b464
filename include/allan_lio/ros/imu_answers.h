// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace allan_lio {

/// Whether every IMU sample got its odometry, as far as the stamps that came tell. A sample that the propagation sees
/// only after a newer state of the filter's gets none, because that state says more: such a gap ends with the first
/// sample after a state. Every other gap is a loss.
class ImuAnswers {
 public:
  /// Stamps in rising order, of either kind.
  void saw_state(const ros::Time& stamp) { states_.push_back(stamp); }
  void saw_odometry(const ros::Time& stamp);

  struct Missing {
    std::uint64_t superseded = 0, lost = 0;  ///< samples
  };
  Missing missing() const;

 private:
  std::vector<ros::Time> states_;
  std::vector<std::pair<ros::Time, ros::Time>> gaps_;  ///< the last stamp before and the first one after
  ros::Time last_;
  ros::Duration interval_;  ///< the shortest between two
};

}  // namespace allan_lio
