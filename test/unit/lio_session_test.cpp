// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_session.h"

#include <gtest/gtest.h>

#include <cstring>

#include "allan_lio/ros/conversions.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1600000000 * kNsPerSecond;
constexpr TimeNs kImuStep = 5'000'000;     // [ns]
constexpr TimeNs kScanStep = 100'000'000;  // [ns]
constexpr int kScans = 40;
constexpr std::size_t kLostAtTheStart = 2;  // scans before the first IMU sample that counts
constexpr float kHalfRoom = 4.0F;           // [m]
constexpr double kGravity = 9.80665;

/// The walls, floor and ceiling of a cube, seen from its middle.
sensor_msgs::PointCloud2 room(TimeNs stamp) {
  std::vector<WorldPoint> points;
  for (float a = -3.9F; a < kHalfRoom; a += 0.25F) {
    for (float b = -3.9F; b < kHalfRoom; b += 0.25F) {
      for (const float c : {-kHalfRoom, kHalfRoom}) {
        points.push_back({a, b, c, 1.0F});
        points.push_back({a, c, b, 1.0F});
        points.push_back({c, a, b, 1.0F});
      }
    }
  }
  return *to_cloud(points, "lidar", stamp);
}

sensor_msgs::Imu at_rest(TimeNs stamp) {
  sensor_msgs::Imu message;
  message.header.stamp = to_ros_time(stamp);
  message.linear_acceleration.z = kGravity;
  return message;
}

LioConfig config() {
  LioConfig config = simulated_robot();
  config.lidar.deskew = false;  // the clouds have no time
  return config;
}

/// A session that keeps its results.
struct RecordedRun {
  std::vector<LioResult> results;
  LioSession session{config(), "", [this](const LioResult& result) { results.push_back(result); }};

  void standstill(TimeNs from) {
    for (int i = 0; i < kScans; ++i) {
      const TimeNs stamp = from + i * kScanStep;
      for (TimeNs t = stamp; t < stamp + kScanStep; t += kImuStep) session.add(at_rest(t));
      EXPECT_EQ(session.add(room(stamp)), "");
    }
  }
};

TEST(LioSession, starts_again_once_when_the_recording_begins_anew) {
  RecordedRun run;
  run.standstill(kStart);
  const std::size_t first_pass = run.results.size();
  ASSERT_GE(first_pass + kLostAtTheStart, std::size_t{kScans});
  EXPECT_EQ(run.session.restarted(), "");

  run.standstill(kStart);
  run.session.end_of_data();
  EXPECT_NE(run.session.restarted().find("went back by"), std::string::npos) << run.session.restarted();
  EXPECT_EQ(run.session.restarts(), 1U);
  EXPECT_GE(run.results.size() + 2 * kLostAtTheStart, 2 * first_pass);
  EXPECT_LT(run.results.back().state.nav.stamp, kStart + kScans * kScanStep);
  EXPECT_EQ(run.session.odometry().counters().scans_read, 2U * kScans);
}

TEST(LioSession, a_cloud_from_before_the_restart_does_not_stop_the_new_one) {
  RecordedRun run;
  run.standstill(kStart);
  for (int i = 0; i < 15; ++i) run.session.add(at_rest(kStart + i * kImuStep));
  ASSERT_NE(run.session.restarted(), "");
  run.session.add(room(kStart + kScans * kScanStep));
  const std::size_t before = run.results.size();
  run.standstill(kStart + kScanStep);
  EXPECT_GE(run.results.size() + kLostAtTheStart, before + kScans);
}

TEST(LioSession, a_few_stray_old_samples_are_dropped_and_nothing_else) {
  RecordedRun run;
  run.standstill(kStart);
  for (int i = 0; i < 5; ++i) run.session.add(at_rest(kStart + i * kImuStep));
  const std::size_t before = run.results.size();
  run.standstill(kStart + kScans * kScanStep);
  EXPECT_EQ(run.session.restarted(), "");
  EXPECT_GE(run.results.size() + 1, before + kScans);
  EXPECT_EQ(run.session.odometry().counters().imu_dropped_order, 5U);
}

}  // namespace
}  // namespace allan_lio
