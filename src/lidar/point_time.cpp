// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/point_time.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

namespace allan_lio {
namespace {

using Origin = PointTimeRule::Origin;

/// Times and stamps come from different clocks when they differ by more than this [s].
constexpr double kClockTolerance = 2.0;
/// A sweep that begins this much [s] before its stamp still begins at it: rounding, and lasers ahead of the head.
constexpr double kEdgeTolerance = 2e-3;
/// A field that counts a sweep in fewer steps does not tell its points apart.
constexpr double kFewestSteps = 16.0;

struct Unit {
  TimeUnit code;
  const char* name;
  double ns;
};
constexpr std::array<Unit, 4> kUnits{{{TimeUnit::kSeconds, "s", 1e9},
                                      {TimeUnit::kMilliseconds, "ms", 1e6},
                                      {TimeUnit::kMicroseconds, "us", 1e3},
                                      {TimeUnit::kNanoseconds, "ns", 1.0}}};

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string field_text(const PointTimeEvidence& evidence) {
  return "field '" + evidence.field + "' (" + number_type_name(evidence.type) + ", " + number(evidence.smallest) +
         " to " + number(evidence.largest) + ")";
}

/// The step in which the field counts where its values are largest: 1 for integers.
double resolution(const PointTimeEvidence& evidence) {
  const double largest = std::max(std::abs(evidence.smallest), std::abs(evidence.largest));
  if (evidence.type == NumberType::kFloat32) return largest * std::numeric_limits<float>::epsilon();
  if (evidence.type == NumberType::kFloat64) return largest * std::numeric_limits<double>::epsilon();
  return 1.0;
}

/// Empty if the field tells the points of a sweep apart.
std::string too_coarse(const PointTimeEvidence& evidence) {
  const double step = resolution(evidence);
  const bool equal = evidence.largest == evidence.smallest;
  if (!equal && evidence.largest - evidence.smallest >= kFewestSteps * step) return "";
  const std::string way_out = "; name the right field in lidar/time_field, or set lidar/deskew: false";
  if (equal && step <= 1.0) return "all points have the same time: " + field_text(evidence) + way_out;
  return field_text(evidence) + " cannot tell the points of a sweep apart: " + number_type_name(evidence.type) +
         " counts in steps of " + number(step) + " at such values" + way_out;
}

std::optional<Unit> find_unit(const PointTimeEvidence& evidence, TimeUnit wanted, std::string& refusal) {
  const double span = evidence.largest - evidence.smallest;
  const bool told = wanted != TimeUnit::kAuto;
  const double shortest = told ? PointTimeDetector::kShortestTold : PointTimeDetector::kShortestSweep;
  const auto plausible_sweep = [shortest](double seconds) {
    return seconds >= shortest && seconds <= PointTimeDetector::kLongestSweep;
  };
  for (const Unit& unit : kUnits) {
    if ((!told || wanted == unit.code) && plausible_sweep(1e-9 * unit.ns * span)) return unit;
  }
  if (!told) {
    refusal = "no unit of s, ms, us, ns makes a sweep of 0.01 to 1 s of " + field_text(evidence) +
              "; name the right field in lidar/time_field, or set lidar/deskew: false";
    return std::nullopt;
  }
  const Unit& unit = *std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.code == wanted; });
  refusal = field_text(evidence) + " lasts " + number(1e-9 * unit.ns * span) + " s in " +
            (evidence.unit == wanted ? "" : "lidar/time_unit: ") + unit.name + ", which is no sweep (0.001 to 1 s)" +
            (evidence.unit == wanted ? "" : "; set lidar/time_unit: auto");
  return std::nullopt;
}

/// The field as seconds.
struct Span {
  double first, last;
  double length() const { return last - first; }
  /// Zero lies inside the sweep, or no more than a sweep's length off it.
  bool near_zero() const { return first - length() <= 0.0 && last + length() >= 0.0; }
  bool near_clock(double stamp) const { return std::abs(0.5 * (first + last) - stamp) <= kClockTolerance; }
};

std::optional<Origin> find_origin(const PointTimeEvidence& evidence, const Span& span, PointTime wanted,
                                  std::string& refusal) {
  const double stamp = 1e-9 * static_cast<double>(evidence.stamp);
  const bool clock = span.near_clock(stamp) && evidence.type != NumberType::kFloat32;
  switch (wanted) {
    case PointTime::kStart:
      return span.near_zero() && span.first >= -kEdgeTolerance ? Origin::kStamp : Origin::kSweepStart;
    case PointTime::kEnd:
      return span.near_zero() && span.last <= kEdgeTolerance ? Origin::kStamp : Origin::kSweepEnd;
    case PointTime::kAbsolute:
      if (clock) return Origin::kEpoch;
      break;
    case PointTime::kAuto:
      if (span.near_zero()) return Origin::kStamp;
      if (clock) return Origin::kEpoch;
      break;
    case PointTime::kAzimuthClockwise:
    case PointTime::kAzimuthCounterclockwise:  // no field is looked at
      break;
  }
  refusal = field_text(evidence) + " counts neither from the header stamp nor with its clock: it is " +
            number(0.5 * (span.first + span.last) - stamp) +
            " s off the stamp; if the stamp is right, set lidar/point_time: start or end to what it marks";
  return std::nullopt;
}

std::string origin_text(Origin origin, const Span& span) {
  switch (origin) {
    case Origin::kEpoch:
      return "of the clock";
    case Origin::kSweepStart:
      return "whose first value in a scan is at the header stamp";
    case Origin::kSweepEnd:
      return "whose last value in a scan is at the header stamp";
    case Origin::kStamp:
      break;
  }
  if (span.first >= -kEdgeTolerance) return "since the sweep's start, the header stamp";
  if (span.last <= kEdgeTolerance) return "before the sweep's end, the header stamp";
  return "about the header stamp, which lies inside the sweep";
}

}  // namespace

std::string number_type_name(NumberType type) {
  const std::array<const char*, 10> names{"int8",   "uint8",   "int16",   "uint16", "int32",
                                          "uint32", "float32", "float64", "int64",  "uint64"};
  const std::size_t index = static_cast<std::size_t>(type) - 1;
  return index < names.size() ? names[index] : "unknown type";
}

bool is_point_time_name(const std::string& name) {
  const std::vector<std::string> known{"t", "time", "timestamp", "time_stamp", "offset_time"};
  return std::find(known.begin(), known.end(), name) != known.end();
}

std::optional<PointTimeRule> judge_point_time(const PointTimeEvidence& evidence, const LioConfig::Lidar& options,
                                              std::string& refusal) {
  refusal.clear();
  if (evidence.points == 0) {
    refusal = "no scan held a valid point";
    return std::nullopt;
  }
  refusal = too_coarse(evidence);
  if (!refusal.empty()) return std::nullopt;
  const TimeUnit told = evidence.unit == TimeUnit::kAuto ? options.time_unit : evidence.unit;
  const std::optional<Unit> unit = find_unit(evidence, told, refusal);
  if (!unit) return std::nullopt;
  const Span span{1e-9 * unit->ns * evidence.smallest, 1e-9 * unit->ns * evidence.largest};
  const std::optional<Origin> origin = find_origin(evidence, span, options.point_time, refusal);
  if (!origin) return std::nullopt;

  PointTimeRule rule;
  rule.origin = *origin;
  rule.ns_per_unit = unit->ns;
  rule.sweep = span.length();
  const bool relative = *origin == Origin::kStamp;
  rule.verdict = "point time: field '" + evidence.field + "' " + number_type_name(evidence.type) + " in " + unit->name +
                 " " + origin_text(*origin, span) + " (" +
                 (relative ? number(span.first) + " to " + number(span.last) + " s)"
                           : "a sweep of " + number(span.length()) + " s)");
  return rule;
}

void PointTimeDetector::examine(const PointTimeEvidence& evidence) {
  if (settled()) return;
  if (evidence.points < kEnoughPoints) {
    refusal_ =
        "the scans hold fewer than " + std::to_string(kEnoughPoints) + " valid points, too few to tell the point time";
    return;
  }
  ++trials_;
  rule_ = judge_point_time(evidence, options_, refusal_);
}

PointTimeScale::PointTimeScale(const PointTimeRule& rule, TimeNs stamp, double first_raw)
    : zero_(0.0), ns_per_unit_(rule.ns_per_unit) {
  if (rule.origin == Origin::kSweepStart || rule.origin == Origin::kSweepEnd) zero_ = first_raw;
  if (rule.origin != Origin::kEpoch) return;
  // A double holds the epoch's seconds to 0.2 us only: subtract whole units, which are exact, and add the rest.
  const TimeNs unit = static_cast<TimeNs>(rule.ns_per_unit);
  zero_ = static_cast<double>(stamp / unit);
  remainder_ns_ = static_cast<double>(static_cast<TimeNs>(zero_) * unit - stamp);
}

}  // namespace allan_lio
