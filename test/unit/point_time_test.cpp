// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/lidar/point_time.h"

#include <gtest/gtest.h>

namespace allan_lio {
namespace {

using Origin = PointTimeRule::Origin;

constexpr TimeNs kStamp = 1317042000'123456789;
constexpr double kStampSeconds = 1317042000.123456789;
constexpr double kHalfMicrosecond = 500.0;  // [ns], what a double keeps of the epoch's seconds

LioConfig::Lidar automatic() {
  LioConfig::Lidar options{};
  options.deskew = true;
  options.point_time = PointTime::kAuto;
  options.time_unit = TimeUnit::kAuto;
  return options;
}

PointTimeEvidence evidence(const std::string& field, NumberType type, double smallest, double largest) {
  return {field, type, smallest, largest, 20000, kStamp};
}

struct Judgement {
  std::optional<PointTimeRule> rule;
  std::string refusal;
};

Judgement judge(const PointTimeEvidence& seen, const LioConfig::Lidar& options = automatic()) {
  Judgement judgement;
  judgement.rule = judge_point_time(seen, options, judgement.refusal);
  return judgement;
}

TEST(PointTime, velodyne_seconds_count_from_the_start) {
  const auto found = judge(evidence("time", NumberType::kFloat32, 0.0, 0.0999));
  ASSERT_TRUE(found.rule) << found.refusal;
  EXPECT_EQ(found.rule->origin, Origin::kStamp);
  EXPECT_EQ(found.rule->ns_per_unit, 1e9);
  EXPECT_EQ(found.rule->verdict,
            "point time: field 'time' float32 in s since the sweep's start, the header stamp (0 to 0.0999 s)");
}

TEST(PointTime, older_velodyne_seconds_count_back_from_the_end) {
  const auto found = judge(evidence("time", NumberType::kFloat32, -0.0999, 0.0));
  ASSERT_TRUE(found.rule) << found.refusal;
  EXPECT_EQ(found.rule->origin, Origin::kStamp);
  EXPECT_NE(found.rule->verdict.find("before the sweep's end"), std::string::npos) << found.rule->verdict;
}

TEST(PointTime, a_stamp_inside_the_sweep_is_told) {
  const auto found = judge(evidence("time", NumberType::kFloat32, -0.05, 0.05));
  ASSERT_TRUE(found.rule) << found.refusal;
  EXPECT_NE(found.rule->verdict.find("inside the sweep"), std::string::npos) << found.rule->verdict;
}

TEST(PointTime, ouster_nanoseconds_and_livox_nanoseconds_are_told) {
  for (const char* field : {"t", "offset_time"}) {
    const auto found = judge(evidence(field, NumberType::kUint32, 0, 99'900'000));
    ASSERT_TRUE(found.rule) << found.refusal;
    EXPECT_EQ(found.rule->origin, Origin::kStamp);
    EXPECT_EQ(found.rule->ns_per_unit, 1.0);
  }
}

TEST(PointTime, milliseconds_and_microseconds_are_told) {
  EXPECT_EQ(judge(evidence("t", NumberType::kFloat32, 0, 99.9)).rule->ns_per_unit, 1e6);
  EXPECT_EQ(judge(evidence("t", NumberType::kUint32, 0, 99'900)).rule->ns_per_unit, 1e3);
}

TEST(PointTime, hesai_and_robosense_seconds_are_of_the_clock) {
  const auto found = judge(evidence("timestamp", NumberType::kFloat64, kStampSeconds, kStampSeconds + 0.0999));
  ASSERT_TRUE(found.rule) << found.refusal;
  EXPECT_EQ(found.rule->origin, Origin::kEpoch);
  const PointTimeScale scale(*found.rule, kStamp, 0.0);
  EXPECT_NEAR(scale.offset_ns(kStampSeconds + 0.05), 0.05e9, kHalfMicrosecond);
  EXPECT_NEAR(scale.offset_ns(kStampSeconds), 0.0, kHalfMicrosecond);
}

TEST(PointTime, nanoseconds_of_the_clock_are_told_in_a_double) {
  const double stamp = static_cast<double>(kStamp);
  const auto found = judge(evidence("timestamp", NumberType::kFloat64, stamp, stamp + 1e8));
  ASSERT_TRUE(found.rule) << found.refusal;
  EXPECT_EQ(found.rule->origin, Origin::kEpoch);
  EXPECT_EQ(found.rule->ns_per_unit, 1.0);
  EXPECT_NEAR(PointTimeScale(*found.rule, kStamp, 0.0).offset_ns(stamp + 5e7), 5e7, kHalfMicrosecond);
}

TEST(PointTime, times_of_another_clock_are_refused_and_the_sentence_names_the_way_out) {
  const auto seen = evidence("timestamp", NumberType::kFloat64, 5000.0, 5000.0999);
  const auto found = judge(seen);
  ASSERT_FALSE(found.rule);
  EXPECT_NE(found.refusal.find("'timestamp'"), std::string::npos) << found.refusal;
  EXPECT_NE(found.refusal.find("lidar/point_time"), std::string::npos) << found.refusal;

  LioConfig::Lidar options = automatic();
  options.point_time = PointTime::kStart;
  ASSERT_TRUE(judge(seen, options).rule);
  EXPECT_EQ(judge(seen, options).rule->origin, Origin::kSweepStart);
  options.point_time = PointTime::kEnd;
  EXPECT_EQ(judge(seen, options).rule->origin, Origin::kSweepEnd);
  options.point_time = PointTime::kAbsolute;
  EXPECT_FALSE(judge(seen, options).rule);
}

TEST(PointTime, an_anchor_given_in_so_many_words_moves_the_sweep) {
  LioConfig::Lidar options = automatic();
  options.point_time = PointTime::kEnd;
  EXPECT_EQ(judge(evidence("time", NumberType::kFloat32, 0.0, 0.0999), options).rule->origin, Origin::kSweepEnd);
  EXPECT_EQ(judge(evidence("time", NumberType::kFloat32, -0.0999, 0.0), options).rule->origin, Origin::kStamp);
}

TEST(PointTime, equal_times_are_refused) {
  const auto found = judge(evidence("time", NumberType::kFloat32, 0.0, 0.0));
  ASSERT_FALSE(found.rule);
  EXPECT_NE(found.refusal.find("same time"), std::string::npos) << found.refusal;
}

TEST(PointTime, a_span_that_is_no_sweep_in_any_unit_is_refused) {
  for (const double span : {2.0, 5.0, 0.003}) {
    const auto found = judge(evidence("time", NumberType::kFloat64, 0.0, span));
    EXPECT_FALSE(found.rule) << span;
    EXPECT_NE(found.refusal.find("no unit"), std::string::npos) << found.refusal;
  }
}

TEST(PointTime, a_unit_that_makes_no_sweep_is_refused_by_name) {
  LioConfig::Lidar options = automatic();
  options.time_unit = TimeUnit::kMilliseconds;
  const auto found = judge(evidence("time", NumberType::kFloat32, 0.0, 0.0999), options);
  ASSERT_FALSE(found.rule);
  EXPECT_NE(found.refusal.find("time_unit: ms"), std::string::npos) << found.refusal;
}

TEST(PointTimeDetector, keeps_to_its_rule) {
  PointTimeDetector detector(automatic());
  detector.examine(evidence("t", NumberType::kUint32, 0, 99'900'000));
  ASSERT_TRUE(detector.settled());
  detector.examine(evidence("t", NumberType::kUint32, 0, 99'900));
  EXPECT_EQ(detector.rule()->ns_per_unit, 1.0);
}

TEST(PointTimeDetector, waits_for_a_scan_with_enough_points) {
  PointTimeDetector detector(automatic());
  PointTimeEvidence few = evidence("t", NumberType::kUint32, 0, 99'900'000);
  few.points = PointTimeDetector::kEnoughPoints - 1;
  for (int i = 0; i < 2 * PointTimeDetector::kTrials; ++i) detector.examine(few);
  EXPECT_FALSE(detector.settled());
  EXPECT_FALSE(detector.refusal().empty());
  few.points = PointTimeDetector::kEnoughPoints;
  detector.examine(few);
  EXPECT_TRUE(detector.rule());
}

TEST(PointTimeDetector, gives_a_partial_first_sweep_another_trial_and_then_refuses_for_good) {
  PointTimeDetector patient(automatic());
  patient.examine(evidence("time", NumberType::kFloat32, 0.0, 0.003));
  EXPECT_FALSE(patient.settled());
  patient.examine(evidence("time", NumberType::kFloat32, 0.0, 0.0999));
  EXPECT_TRUE(patient.rule());

  PointTimeDetector refusing(automatic());
  for (int i = 0; i < PointTimeDetector::kTrials; ++i)
    refusing.examine(evidence("time", NumberType::kFloat32, 0.0, 0.0));
  EXPECT_TRUE(refusing.settled());
  refusing.examine(evidence("time", NumberType::kFloat32, 0.0, 0.0999));
  EXPECT_FALSE(refusing.rule());
}

}  // namespace
}  // namespace allan_lio
