// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/static_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

namespace allan_lio {
namespace {

constexpr TimeNs kPeriod = 5'000'000;  // 200 Hz
constexpr TimeNs kBegin = 1'600'000'000 * kNsPerSecond;

/// White noise of 1, 2, ..., 6 times 1e-3 about means of 1, 2, ... 6, evenly stamped.
std::vector<ImuSample> still_samples(std::size_t count, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1e-3);
  std::vector<ImuSample> samples(count);
  for (std::size_t i = 0; i < count; ++i) {
    samples[i].stamp = kBegin + static_cast<TimeNs>(i) * kPeriod;
    for (int axis = 0; axis < 3; ++axis) {
      samples[i].gyro[axis] = (axis + 1) * (0.001 + normal(random));
      samples[i].accel[axis] = (axis + 4) * (1.0 + normal(random));
    }
  }
  return samples;
}

StaticRecord record_of(const std::vector<ImuSample>& samples, const StaticRecordOptions& options = {}) {
  StaticRecord record(options);
  for (const ImuSample& sample : samples) record.add(sample);
  record.finish();
  return record;
}

bool says(const StaticRecord& record, const std::string& words) {
  for (const std::string& remark : record.remarks())
    if (remark.find(words) != std::string::npos) return true;
  return false;
}

void expect_same_curve(const AllanCurve& a, const AllanCurve& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].m, b[i].m);
    EXPECT_NEAR(a[i].variance, b[i].variance, tolerance * b[i].variance) << "m " << a[i].m;
    EXPECT_NEAR(a[i].tau, b[i].tau, 1e-9 * b[i].tau);
    EXPECT_NEAR(a[i].record_time, b[i].record_time, 1e-9 * b[i].record_time);
    EXPECT_NEAR(a[i].slide_time, b[i].slide_time, 1e-9 * b[i].slide_time);
  }
}

TEST(StaticRecord, ItsCurveIsThatOfTheWholeSeries) {
  constexpr double kRounding = 1e-9;
  const std::vector<ImuSample> samples = still_samples(20001);
  const StaticRecord record = record_of(samples);
  EXPECT_NEAR(record.tau0(), 0.005, 1e-12);
  EXPECT_NEAR(record.duration(), 100.005, 1e-6);
  EXPECT_EQ(record.pieces(), 1U);
  EXPECT_TRUE(record.remarks().empty()) << record.remarks().front();
  EXPECT_EQ(record.motion(), "");
  EXPECT_LT(record.jitter(), 1e-9);
  for (int axis = 0; axis < StaticRecord::kAxes; ++axis) {
    IntegratedSeries series;
    series.tau0 = 0.005;
    series.x = {0.0};
    double sum = 0.0;
    for (const ImuSample& s : samples) {
      const double y = axis < 3 ? s.gyro[axis] : s.accel[axis - 3];
      series.x.push_back(series.x.back() + 0.005 * y);
      sum += y;
    }
    const AllanCurve expected = overlapping_allan_variance(series, log_spaced_factors(20001 / 3, 10));
    expect_same_curve(record.curve(axis, 10, 2), expected, 1e-6);
    expect_same_curve(overlapping_allan_variance(record.series(axis), log_spaced_factors(20001 / 3, 10)), expected,
                      1e-6);
    EXPECT_NEAR(record.mean(axis), sum / 20001.0, kRounding);
    EXPECT_NEAR(record.deviation(axis), 1e-3 * (axis + 1), 0.03e-3 * (axis + 1));
  }
}

TEST(StaticRecord, UnitsScaleWhatItGives) {
  const std::vector<ImuSample> samples = still_samples(3000);
  StaticRecord record = record_of(samples);
  const AllanCurve gyro = record.curve(1, 5, 1), accel = record.curve(4, 5, 1);
  const double mean = record.mean(4);
  record.set_units(2.0, 10.0);
  for (std::size_t i = 0; i < gyro.size(); ++i) {
    EXPECT_NEAR(record.curve(1, 5, 1)[i].variance, 4.0 * gyro[i].variance, 1e-12 * gyro[i].variance);
    EXPECT_NEAR(record.curve(4, 5, 1)[i].variance, 100.0 * accel[i].variance, 1e-12 * accel[i].variance);
  }
  EXPECT_NEAR(record.mean(4), 10.0 * mean, 1e-12);
}

TEST(StaticRecord, AShortGapIsBridgedByAStraightLine) {
  std::vector<ImuSample> samples = still_samples(2000);
  const std::vector<ImuSample> whole = samples;
  samples.erase(samples.begin() + 1000, samples.begin() + 1010);
  std::vector<ImuSample> bridged = whole;
  for (int i = 0; i < 10; ++i) {
    const double part = (i + 1) / 11.0;
    ImuSample& s = bridged[static_cast<std::size_t>(1000 + i)];
    s.gyro = (1.0 - part) * whole[999].gyro + part * whole[1010].gyro;
    s.accel = (1.0 - part) * whole[999].accel + part * whole[1010].accel;
  }
  const StaticRecord record = record_of(samples), expected = record_of(bridged);
  EXPECT_EQ(record.faults().bridged_gaps, 1);
  EXPECT_EQ(record.faults().bridged_samples, 10);
  EXPECT_EQ(record.faults().long_gaps, 0);
  EXPECT_EQ(record.pieces(), 1U);
  EXPECT_NEAR(record.faults().longest_gap, 0.05, 1e-6);
  EXPECT_TRUE(says(record, "10 samples missing in 1 short gap"));
  for (int axis = 0; axis < 6; ++axis) expect_same_curve(record.curve(axis, 5, 1), expected.curve(axis, 5, 1), 1e-9);
}

TEST(StaticRecord, ALongGapBeginsANewPiece) {
  std::vector<ImuSample> samples = still_samples(2000);
  samples.erase(samples.begin() + 800, samples.begin() + 811);
  const StaticRecord record = record_of(samples);
  EXPECT_EQ(record.faults().long_gaps, 1);
  EXPECT_EQ(record.faults().bridged_samples, 0);
  ASSERT_EQ(record.pieces(), 2U);
  EXPECT_EQ(record.series(0).starts, (std::vector<std::size_t>{0, 801}));
  EXPECT_EQ(record.series(0).x[801], 0.0);
  EXPECT_NEAR(record.tau0(), 0.005, 1e-12) << "a gap does not change the rate";
  EXPECT_NEAR(record.duration(), 1989 * 0.005, 1e-9);
  EXPECT_TRUE(says(record, "1 gap of more than 10 samples, the longest 0.055 s"));
}

TEST(StaticRecord, GapsAreFoundUnderJitterAndAWrongClockRate) {
  std::vector<ImuSample> samples = still_samples(200000);
  std::mt19937 random(7);
  std::exponential_distribution<double> delay(1.0 / 0.7e6);  // 0.7 ms of 5 ms
  for (ImuSample& s : samples)
    s.stamp = kBegin + to_ns(1.0003e-9 * static_cast<double>(s.stamp - kBegin)) + static_cast<TimeNs>(delay(random));
  for (std::size_t i = 1; i < samples.size(); ++i)
    samples[i].stamp = std::max(samples[i].stamp, samples[i - 1].stamp + 10'000);
  for (const std::ptrdiff_t at : {150000, 100000, 50000}) samples.erase(samples.begin() + at, samples.begin() + at + 3);
  const StaticRecord record = record_of(samples);
  EXPECT_EQ(record.faults().bridged_gaps, 3);
  EXPECT_EQ(record.faults().bridged_samples, 9);
  EXPECT_EQ(record.faults().long_gaps, 0);
  EXPECT_NEAR(record.tau0(), 1.0003 * 0.005, 1e-7);
  EXPECT_NEAR(record.jitter(), 0.7e-3, 0.05e-3);
  EXPECT_TRUE(says(record, "the stamps scatter by"));
}

TEST(StaticRecord, ALateSampleMadeUpByTheNextOnesIsNoGap) {
  std::vector<ImuSample> samples = still_samples(5000);
  const std::size_t stall = 30;  // samples that come at once after a stall
  for (std::size_t i = 0; i < stall; ++i)
    samples[3000 + i].stamp = samples[3000 + stall].stamp - static_cast<TimeNs>(stall - i) * 1000;
  const StaticRecord record = record_of(samples);
  EXPECT_EQ(record.faults().bridged_gaps, 0);
  EXPECT_EQ(record.faults().long_gaps, 0);
  EXPECT_EQ(record.samples(), 5000);
  EXPECT_NEAR(record.tau0(), 0.005, 1e-9);
}

TEST(StaticRecord, BatchesOfADriverAreNoGaps) {
  std::vector<ImuSample> samples = still_samples(20000);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t batch_end = i / 8 * 8 + 7;
    samples[i].stamp = kBegin + static_cast<TimeNs>(batch_end) * kPeriod + static_cast<TimeNs>(i % 8) * 100'000;
  }
  samples.erase(samples.begin() + 9000, samples.begin() + 9002);
  const StaticRecord record = record_of(samples);
  EXPECT_NEAR(record.tau0(), 0.005, 2e-6) << "the first batch's delay of 35 ms in 100 s";
  EXPECT_EQ(record.faults().bridged_samples, 2);
  EXPECT_EQ(record.faults().long_gaps, 0);
  EXPECT_TRUE(says(record, "the stamps scatter by"));
}

TEST(StaticRecord, NanAndBackwardStampsAreDroppedAndCounted) {
  std::vector<ImuSample> samples = still_samples(3000);
  const std::vector<ImuSample> whole = samples;
  ImuSample stray = samples[1000];
  stray.gyro.setConstant(99.0);
  samples.insert(samples.begin() + 1001, stray);  // the same stamp again
  stray.stamp -= 3 * kPeriod;
  samples.insert(samples.begin() + 1500, stray);  // an earlier one
  stray = samples[2000];
  stray.stamp += 1000;
  stray.accel.y() = std::numeric_limits<double>::quiet_NaN();
  samples.insert(samples.begin() + 2001, stray);
  stray.accel.y() = std::numeric_limits<double>::infinity();
  samples.insert(samples.begin() + 2002, stray);
  const StaticRecord record = record_of(samples), expected = record_of(whole);
  EXPECT_EQ(record.faults().backward, 2);
  EXPECT_EQ(record.faults().not_finite, 2);
  EXPECT_EQ(record.samples(), 3000);
  for (int axis = 0; axis < 6; ++axis) expect_same_curve(record.curve(axis, 5, 1), expected.curve(axis, 5, 1), 0.0);
  EXPECT_TRUE(says(record, "2 samples dropped for NaN or inf"));
  EXPECT_TRUE(says(record, "2 samples dropped for a stamp not later"));
}

TEST(StaticRecord, OneStampFromTheFutureDoesNotEndTheRecord) {
  std::vector<ImuSample> samples = still_samples(3000);
  samples[1000].stamp += 3600 * kNsPerSecond;
  const StaticRecord record = record_of(samples);
  EXPECT_GE(record.samples(), 2980);
  EXPECT_EQ(record.faults().clock_set_back, 1);
  EXPECT_NEAR(record.tau0(), 0.005, 1e-9);
  EXPECT_NEAR(record.duration(), 15.0, 0.1);
}

TEST(StaticRecord, AGivenRateNeedsNoStamps) {
  std::vector<ImuSample> samples = still_samples(3000);
  const StaticRecord stamped = record_of(samples);
  for (ImuSample& s : samples) s.stamp = 0;
  StaticRecordOptions options;
  options.rate = 200.0;
  const StaticRecord record = record_of(samples, options);
  EXPECT_EQ(record.tau0(), 0.005);
  EXPECT_EQ(record.faults().backward, 0);
  expect_same_curve(record.curve(2, 10, 1), stamped.curve(2, 10, 1), 1e-12);

  samples[100].gyro.x() = std::numeric_limits<double>::quiet_NaN();
  const StaticRecord with_hole = record_of(samples, options);
  EXPECT_EQ(with_hole.faults().not_finite, 1);
  EXPECT_EQ(with_hole.faults().bridged_samples, 1) << "the place of the dropped sample stays";
  EXPECT_NEAR(with_hole.duration(), 15.0, 1e-12);
}

TEST(StaticRecord, DecimationKeepsWhatTheWholeRecordWouldGive) {
  const std::vector<ImuSample> samples = still_samples(100000);
  StaticRecordOptions small;
  small.max_samples = 8192;
  const StaticRecord whole = record_of(samples), decimated = record_of(samples, small);
  EXPECT_EQ(decimated.stride(), 16);
  EXPECT_LE(decimated.series(0).x.size(), small.max_samples);
  EXPECT_NEAR(decimated.series(0).tau0, 16 * 0.005, 1e-9);
  EXPECT_TRUE(says(decimated, "one integrated value is kept for every 16 samples"));

  // Frozen: exactly the curve of what had been read when the memory was full, 8191 samples and then twice as many.
  const AllanCurve curve = decimated.curve(3, 10, 1);
  const AllanCurve first = record_of({samples.begin(), samples.begin() + 8191}).curve(3, 40, 1);
  int frozen = 0, kept = 0;
  for (const AllanPoint& point : curve) {
    const auto same = [&](const AllanPoint& p) { return p.m == point.m; };
    if (point.m < 16) {
      const auto expected = std::find_if(first.begin(), first.end(), same);
      if (expected == first.end()) continue;
      ++frozen;
      EXPECT_NEAR(point.variance, expected->variance, 1e-9 * expected->variance);
      EXPECT_NEAR(point.record_time, 8191 * 0.005, 1e-6);
      EXPECT_NEAR(point.tau, static_cast<double>(point.m) * 0.005, 1e-9);
    } else if (point.m >= 128) {
      // Less overlap costs a little, but these are the same sums.
      IntegratedSeries series = whole.series(3);
      const AllanPoint expected = overlapping_allan_variance(series, {point.m}).front();
      ++kept;
      EXPECT_NEAR(point.variance, expected.variance, 0.02 * expected.variance) << "m " << point.m;
      EXPECT_NEAR(point.record_time, 500.0, 0.1);
      EXPECT_NEAR(point.slide_time, expected.slide_time, 0.1);
      EXPECT_EQ(point.m % 16, 0);
    }
  }
  EXPECT_GE(frozen, 8);
  EXPECT_GE(kept, 20);
  for (std::size_t i = 1; i < curve.size(); ++i) EXPECT_GT(curve[i].m, curve[i - 1].m);
  EXPECT_NEAR(static_cast<double>(curve.size()), static_cast<double>(whole.curve(3, 10, 1).size()), 2.0);
  EXPECT_GT(static_cast<double>(curve.back().m), 100000.0 / 3.0 / 1.3);
}

TEST(StaticRecord, DecimationKeepsThePiecesApart) {
  std::vector<ImuSample> samples = still_samples(40000);
  for (std::size_t i = 0; i < samples.size(); ++i)  // a level of its own for every 5000 samples, 1 s apart
    samples[i].stamp += static_cast<TimeNs>(i / 5000) * kNsPerSecond,
        samples[i].gyro.x() += static_cast<double>(i / 5000);
  StaticRecordOptions small;
  small.max_samples = 4096;
  const StaticRecord whole = record_of(samples), decimated = record_of(samples, small);
  EXPECT_EQ(whole.pieces(), 8U);
  EXPECT_EQ(decimated.pieces(), 8U);
  const AllanCurve curve = decimated.curve(0, 10, 1);
  for (const AllanPoint& point : curve)
    EXPECT_NEAR(point.variance, 1e-6 / static_cast<double>(point.m), 0.6e-6 / static_cast<double>(point.m));
  EXPECT_GT(curve.back().m, 1200);
}

TEST(StaticRecord, AShortRecordHasAShortCurve) {
  EXPECT_TRUE(record_of({}).curve(0, 10, 1).empty());
  EXPECT_EQ(record_of({}).tau0(), 0.0);
  const std::vector<ImuSample> samples = still_samples(50);
  EXPECT_EQ(record_of({samples.begin(), samples.begin() + 1}).tau0(), 0.0);
  const StaticRecord record = record_of(samples);
  EXPECT_NEAR(record.tau0(), 0.005, 1e-12);
  EXPECT_EQ(record.samples(), 50);
  EXPECT_EQ(record.curve(0, 10, 1).back().m, 16);
}

TEST(StaticRecord, MotionIsSaid) {
  std::vector<ImuSample> samples = still_samples(20000);
  for (std::size_t i = 10500; i < 10700; ++i) samples[i].accel.x() += std::sin(0.1 * static_cast<double>(i));
  EXPECT_NE(record_of(samples).motion().find("in 1 of 10 stretches of 10 s"), std::string::npos);
  EXPECT_NE(record_of(samples).motion().find("first at 50 s"), std::string::npos);

  samples = still_samples(20000);
  for (std::size_t i = 14000; i < 20000; ++i) samples[i].gyro.z() += 0.05;
  EXPECT_NE(record_of(samples).motion().find("in 3 of 10"), std::string::npos);

  samples = still_samples(20000);
  for (std::size_t i = 0; i < samples.size(); ++i) samples[i].gyro.z() += std::sin(0.01 * static_cast<double>(i));
  EXPECT_NE(record_of(samples).motion().find("not at rest"), std::string::npos);
}

TEST(StaticRecord, OptionsThatMakeNoSenseAreRefused) {
  StaticRecordOptions options;
  options.rate = -1.0;
  EXPECT_THROW(StaticRecord{options}, std::invalid_argument);
  options.rate = 0.0;
  options.max_samples = 63;
  EXPECT_THROW(StaticRecord{options}, std::invalid_argument);
}

}  // namespace
}  // namespace allan_lio
