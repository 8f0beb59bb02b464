// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "allan_lio/lio/lio_result.h"

namespace allan_lio {

/// Mean NIS per degree of freedom over some scans, and where it lies with 95 % probability if the filter is honest.
struct NisWindow {
  int scans = 0;  ///< with an update; 0: nothing is known, and the rest is 0
  double mean = 0.0, low = 0.0, high = 0.0;
};

/// Messages that were sent and did not arrive; of a recording that is read offline none.
struct LostOnTheWay {
  std::uint64_t imu = 0, scans = 0;
};

/// What is dropped or doubtful, by reason, in the words of summary.yaml; reasons that never came up are left out.
struct LossCount {
  std::string reason;
  std::uint64_t count;
};
std::vector<LossCount> count_losses(const LioCounters& counters, std::uint64_t undecodable,
                                    const LostOnTheWay& lost = {});

/// How the filter does: follows its results scan by scan.
class HealthWindow {
 public:
  static constexpr std::size_t kScans = 100;  ///< that means are taken over

  /// `seconds`: CPU time of the scan.
  void add(const LioResult& result, double seconds);
  void clear();

  NisWindow nis() const;
  double mean_seconds() const;   ///< CPU time per scan [s]
  double scan_interval() const;  ///< mean time from one scan's end to the next one's [s]; 0 before the second scan
  int unmatched_in_a_row() const { return unmatched_; }
  bool empty() const { return scans_.empty(); }

 private:
  struct Entry {
    TimeNs stamp;
    double nis;
    int dof;
    double seconds;
  };
  std::deque<Entry> scans_;
  int unmatched_ = 0;
};

enum class HealthLevel { kOk, kWarn, kError };
struct Health {
  HealthLevel level = HealthLevel::kOk;
  std::string message;  ///< all that is wrong at the highest level, or one line on how it goes
};

/// Directions of the pose in which the LiDAR gets less than half of its weight.
int weak_axes(const Localizability& localizability);

/// What else the judgement takes into account.
struct HealthFacts {
  double delay = 0.0;            ///< from a scan's end to its result [s]
  std::uint64_t newly_lost = 0;  ///< since the last judgement
  std::string lost_because;      ///< the reasons of those
  std::string output_trouble;    ///< why results don't reach the disk, empty if they do
};

/// What became of a run that had come back aside of its map, by the step that set it right (LioResult::relocated).
std::string describe_relocation(const PoseVector& step);

/// The health of a filter that gave `last` as its last result.
Health judge_health(const HealthWindow& window, const LioResult& last, const HealthFacts& facts);

}  // namespace allan_lio
