// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/sensor_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1600000000 * kNsPerSecond;
constexpr TimeNs kStep = 5'000'000;  // [ns]

std::vector<TimeNs> even_stamps(int count) {
  std::vector<TimeNs> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(kStart + i * kStep);
  return stamps;
}

/// At rest for `still` [s], then turning.
std::vector<ImuSample> record(double still, double seconds) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<ImuSample> samples;
  for (int i = 0; i * 1e-9 * kStep < seconds; ++i) {
    const double t = i * 1e-9 * kStep;
    ImuSample s;
    s.stamp = kStart + i * kStep;
    s.gyro << 0.01 + 0.002 * normal(random), -0.002 + 0.001 * normal(random), 0.003 + 0.001 * normal(random);
    s.accel << 0.02 * normal(random), 0.02 * normal(random), 9.8 + 0.02 * normal(random);
    if (t >= still) s.gyro.z() += std::sin(3.0 * (t - still));
    samples.push_back(s);
  }
  return samples;
}

bool warns(const std::vector<SensorFinding>& findings, const std::string& words, bool fatal = false) {
  for (const SensorFinding& f : findings)
    if (f.fatal == fatal && f.sentence.find(words) != std::string::npos) return true;
  return false;
}

SensorCheck good_check() {
  SensorCheck check;
  check.imu.emplace();
  check.imu->stamps = check_stamps(even_stamps(2000));
  check.imu->readings = check_imu(record(3.0, 10.0));
  check.imu->frames = {"imu"};
  check.lidar.emplace();
  check.lidar->frames = {"lidar"};
  check.lidar->stamps = check_stamps({kStart, kStart + 100'000'000, kStart + 200'000'000, kStart + 300'000'000});
  check.lidar->model = "lidar/ouster";
  check.lidar->points = 20000;
  check.lidar->sweep = 0.1;
  return check;
}

TEST(StampCheck, EvenStampsHaveARateAndNothingElse) {
  const StampReport report = check_stamps(even_stamps(1000));
  EXPECT_DOUBLE_EQ(report.rate(), 200.0);
  EXPECT_EQ(report.jitter, 0.0);
  EXPECT_EQ(report.gaps + report.not_newer, 0U);
  EXPECT_EQ(report.last - report.first, 999 * kStep);
}

TEST(StampCheck, GapsCopiesAndStepsBackAreCounted) {
  std::vector<TimeNs> stamps = even_stamps(1000);
  stamps.erase(stamps.begin() + 500, stamps.begin() + 600);
  stamps.erase(stamps.begin() + 100);
  stamps.insert(stamps.begin() + 50, stamps[49]);
  stamps.insert(stamps.begin() + 60, stamps[10]);
  const StampReport report = check_stamps(stamps);
  EXPECT_EQ(report.gaps, 2U);
  EXPECT_NEAR(report.longest_gap, 0.505, 1e-9);
  EXPECT_EQ(report.gap_at, kStart + 499 * kStep);
  EXPECT_NEAR(report.lost, 101.0, 1e-6);
  EXPECT_EQ(report.not_newer, 2U);
}

TEST(StampCheck, JitterIsWhatOneStepInTwentyExceeds) {
  std::vector<TimeNs> stamps = even_stamps(1000);
  for (std::size_t i = 0; i < stamps.size(); i += 2) stamps[i] += 1'000'000;
  EXPECT_NEAR(check_stamps(stamps).jitter, 0.002, 1e-9);
}

TEST(StampCheck, NothingAndOneMessageAreNoTrouble) {
  EXPECT_EQ(check_stamps({}).count, 0U);
  EXPECT_EQ(check_stamps({kStart}).rate(), 0.0);
}

TEST(ImuCheck, AStandstillAtTheStartGivesBiasNoiseAndGravity) {
  const ImuReport report = check_imu(record(3.0, 10.0));
  EXPECT_NEAR(report.standstill, 3.0, 0.51);
  EXPECT_NEAR(report.gyro_bias.x(), 0.01, 5e-4);
  EXPECT_NEAR(report.gravity, 9.8, 0.01);
  EXPECT_FALSE(report.in_g);
  // 0.002 rad/s a sample at 200 Hz.
  EXPECT_NEAR(report.gyro_noise, 0.002 * std::sqrt(0.005), 0.1 * 0.002 * std::sqrt(0.005));
  EXPECT_EQ(report.gyro_clipping.samples + report.accel_clipping.samples, 0U);
}

TEST(ImuCheck, ReadingsInGAreTold) {
  std::vector<ImuSample> samples = record(3.0, 10.0);
  for (ImuSample& s : samples) s.accel /= 9.80665;
  const ImuReport report = check_imu(samples);
  EXPECT_TRUE(report.in_g);
  EXPECT_NEAR(report.gravity, 9.8, 0.01);
}

TEST(ImuCheck, OfReadingsInGFiftyAreTheLimitToo) {
  std::vector<ImuSample> samples = record(3.0, 10.0);
  for (ImuSample& s : samples) s.accel /= 9.80665;
  samples[1500].accel = {49, 0, 0};
  samples[1600].accel = {51, 0, 0};
  samples[1700].accel = {450, 0, 0};
  samples[1800].accel = {491, 0, 0};
  const ImuReport report = check_imu(samples);
  EXPECT_TRUE(report.in_g);
  EXPECT_EQ(report.invalid, 3U);
  EXPECT_DOUBLE_EQ(report.largest_accel, 49 * 9.80665);
}

TEST(ImuCheck, AMovingStartHasNoStandstill) { EXPECT_EQ(check_imu(record(0.0, 10.0)).standstill, 0.0); }

TEST(ImuCheck, APlateauAtTheLargestReadingIsSaturationAndOneLargeReadingIsNot) {
  std::vector<ImuSample> samples = record(6.0, 10.0);
  for (ImuSample& s : samples) s.gyro.z() = std::max(-0.9, std::min(s.gyro.z(), 0.9));
  const ImuReport clipped = check_imu(samples);
  EXPECT_EQ(clipped.gyro_clipping.at, clipped.largest_rate);
  EXPECT_GT(clipped.gyro_clipping.samples, 20U);
  samples = record(6.0, 10.0);
  samples[100].gyro.x() = 20.0;
  EXPECT_EQ(check_imu(samples).gyro_clipping.samples, 0U);
}

TEST(ImuCheck, InvalidAndFrozenReadingsAreTold) {
  std::vector<ImuSample> samples = record(3.0, 10.0);
  samples[5].gyro.x() = std::nan("");
  samples[6].accel.x() = 1e4;
  EXPECT_EQ(check_imu(samples).invalid, 2U);
  for (ImuSample& s : samples) s.gyro.setZero(), s.accel = Eigen::Vector3d(0, 0, 9.8);
  EXPECT_TRUE(check_imu(samples).frozen);
  EXPECT_EQ(check_imu({}).gravity, 0.0);
}

TEST(SensorCheck, AGoodRecordHasNoFindings) {
  const std::vector<SensorFinding> findings = judge_sensors(good_check());
  EXPECT_TRUE(findings.empty()) << findings.front().sentence;
}

TEST(SensorCheck, EachTroubleHasItsSentence) {
  struct Trouble {
    const char* words;
    bool fatal;
    std::function<void(SensorCheck&)> make;
  };
  const std::vector<Trouble> troubles{
      {"no topic of sensor_msgs/Imu", true, [](SensorCheck& c) { c.imu.reset(); }},
      {"no topic of point clouds", true, [](SensorCheck& c) { c.lidar.reset(); }},
      {"never change", true, [](SensorCheck& c) { c.imu->readings.frozen = true; }},
      {"no cloud can be decoded", true, [](SensorCheck& c) { c.lidar->undecodable = 4; }},
      {"nothing in common", true, [](SensorCheck& c) { c.imu->stamps.first += 1, c.imu->stamps.last = 2; }},
      {"100 Hz only", false, [](SensorCheck& c) { c.imu->stamps.interval = 0.01; }},
      {"25 Hz only", false, [](SensorCheck& c) { c.imu->stamps.interval = 0.04; }},
      {"neither 1 g nor", false, [](SensorCheck& c) { c.imu->readings.gravity = 8.0; }},
      {"begins in motion", false, [](SensorCheck& c) { c.imu->readings.standstill = 0.0; }},
      {"bias", false, [](SensorCheck& c) { c.imu->readings.gyro_bias.x() = 0.2; }},
      {"deg/s", false, [](SensorCheck& c) { c.imu->readings.largest_rate = 60.0; }},
      {"imu/accel_range", false,
       [](SensorCheck& c) {
         c.imu->readings.accel_clipping = {39.2, 10};
       }},
      {"frame_id is empty", false, [](SensorCheck& c) { c.lidar->frames = {""}; }},
      {"two sensors on one topic", false,
       [](SensorCheck& c) {
         c.imu->frames = {"a", "b"};
       }},
      {"not newer", false, [](SensorCheck& c) { c.imu->stamps.not_newer = 3; }},
      {"uneven", false, [](SensorCheck& c) { c.imu->stamps.jitter = 0.004; }},
      {"few planes", false, [](SensorCheck& c) { c.lidar->points = 80; }},
      {"scans overlap", false, [](SensorCheck& c) { c.lidar->sweep = 0.5; }},
      {"lidar/time_offset", false, [](SensorCheck& c) { c.lidar->delay = 0.5; }},
      {"cut off", false, [](SensorCheck& c) { c.troubles = {"the bag is cut off"}; }},
  };
  for (const Trouble& trouble : troubles) {
    SensorCheck check = good_check();
    trouble.make(check);
    const bool expected = std::string(trouble.words) != "100 Hz only";
    EXPECT_EQ(warns(judge_sensors(check), trouble.words, trouble.fatal), expected) << trouble.words;
  }
}

}  // namespace
}  // namespace allan_lio
