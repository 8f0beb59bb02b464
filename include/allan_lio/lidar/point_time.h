// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "allan_lio/lio/lio_config.h"
#include "allan_lio/math/time.h"

namespace allan_lio {

/// Type of a field's numbers. The values are those of sensor_msgs/PointField, and for 64-bit integers PCL's.
enum class NumberType {
  kInt8 = 1,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kFloat32,
  kFloat64,
  kInt64,
  kUint64,
};

/// "float32" and so on.
std::string number_type_name(NumberType type);

/// True for the names that LiDAR drivers give to the time of a point.
bool is_point_time_name(const std::string& name);

/// What one scan says about its point times, over the points that hold a valid position.
struct PointTimeEvidence {
  std::string field;
  NumberType type = NumberType::kFloat32;
  double smallest = 0.0;            ///< raw value, strays left out
  double largest = 0.0;             ///< raw value, strays left out
  std::size_t points = 0;           ///< with a valid position
  TimeNs stamp = 0;                 ///< of the message's header
  TimeUnit unit = TimeUnit::kAuto;  ///< if the message's type says it
};

/// How a raw value becomes a time.
struct PointTimeRule {
  enum class Origin {
    kStamp,       ///< the header stamp is zero of the field
    kEpoch,       ///< the field holds the clock's time
    kSweepStart,  ///< unknown zero; the smallest value of a scan is at the header stamp
    kSweepEnd,    ///< unknown zero; the largest value of a scan is at the header stamp
  };
  Origin origin = Origin::kStamp;
  double ns_per_unit = 1.0;
  double sweep = 0.1;   ///< length of the first one [s]
  std::string verdict;  ///< one line for the user
};

/// Tells unit and origin of the point times from the first scans, and keeps to it afterwards. A unit is believed
/// when the sweep then lasts between kShortestSweep and kLongestSweep; units lie a factor of 1000 apart, so at most
/// one passes. A unit that the options or the message's type give may make shorter sweeps.
class PointTimeDetector {
 public:
  static constexpr double kShortestSweep = 0.01;  ///< [s]
  static constexpr double kShortestTold = 0.001;  ///< [s], where the unit is given
  static constexpr double kLongestSweep = 1.0;    ///< [s]
  static constexpr std::size_t kEnoughPoints = 100;
  static constexpr int kTrials = 10;  ///< scans with enough points that are looked at before the refusal is final

  explicit PointTimeDetector(const LioConfig::Lidar& options) : options_(options) {}

  /// True once there is nothing left to find out: a rule, or a final refusal.
  bool settled() const { return rule_.has_value() || trials_ >= kTrials; }

  const std::optional<PointTimeRule>& rule() const { return rule_; }

  /// Why there is no rule: a sentence for the user, empty before the first scan and when there is a rule.
  const std::string& refusal() const { return refusal_; }

  /// Looks at a scan. Does nothing once settled.
  void examine(const PointTimeEvidence& evidence);

 private:
  LioConfig::Lidar options_;
  std::optional<PointTimeRule> rule_;
  std::string refusal_;
  int trials_ = 0;
};

/// The rule that the options and the evidence of one scan give. Without one, `refusal` says why.
std::optional<PointTimeRule> judge_point_time(const PointTimeEvidence& evidence, const LioConfig::Lidar& options,
                                              std::string& refusal);

/// Raw values of one scan to offsets from its header stamp [ns].
class PointTimeScale {
 public:
  /// `first_raw`: any valid raw value of the scan, the zero of the origins kSweepStart and kSweepEnd, whose
  /// offsets are to be shifted by the caller so that the smallest or the largest is 0.
  PointTimeScale(const PointTimeRule& rule, TimeNs stamp, double first_raw);

  /// [ns]; not rounded, so that the caller can tell what does not fit its integer.
  double offset_ns(double raw) const { return (raw - zero_) * ns_per_unit_ + remainder_ns_; }

 private:
  double zero_;
  double ns_per_unit_;
  double remainder_ns_ = 0.0;
};

}  // namespace allan_lio
