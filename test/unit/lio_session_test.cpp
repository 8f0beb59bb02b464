// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/lio_session.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/live_parameters.h"
#include "allan_lio/ros/conversions.h"
#include "simulated_drive.h"
#include "temporary_directory.h"

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

TEST(LioSession, an_absurd_reading_in_the_first_second_does_not_hide_that_the_imu_reads_in_g) {
  constexpr int kGlitch = 30;
  RecordedRun run;
  for (int i = 0, k = 0; i < kScans; ++i) {
    const TimeNs stamp = kStart + i * kScanStep;
    for (TimeNs t = stamp; t < stamp + kScanStep; t += kImuStep, ++k) {
      sensor_msgs::Imu message = at_rest(t);
      message.linear_acceleration.z = k == kGlitch ? 450.0 : 1.0;
      run.session.add(message);
    }
    EXPECT_EQ(run.session.add(room(stamp)), "");
  }
  run.session.end_of_data();
  EXPECT_EQ(run.session.odometry().accel_scale(), kGravity);
  EXPECT_EQ(run.session.odometry().counters().imu_dropped_invalid, 1U);
  ASSERT_FALSE(run.session.remarks().empty());
  EXPECT_NE(run.session.remarks().back().find("reads in g"), std::string::npos) << run.session.remarks().back();
}

TEST(LioSession, the_summary_holds_the_parameters_in_force_at_the_end_and_those_at_the_start) {
  TemporaryDirectory directory;
  LioSession session(config(), directory.file("out"), {});
  session.reconfigure(change_live(session.odometry().config(), "imu/k_gb", {{"25"}, false, "a test"}));
  session.finish("complete");
  const YAML::Node summary = YAML::LoadFile(directory.file("out/summary.yaml"));
  EXPECT_EQ(summary["parameters_hash"].as<std::string>(), session.config_hash()) << "as in ~state";
  EXPECT_EQ(summary["parameters"]["imu"]["k_gb"].as<double>(), 25.0);
  EXPECT_EQ(summary["parameters_hash_at_start"].as<std::string>(), config_hash(config()));
  EXPECT_EQ(summary["parameters_at_start"]["imu"]["k_gb"].as<double>(), 1.0);
}

TEST(LioSession, a_run_that_has_come_back_aside_is_told_with_its_moment_and_in_the_summary) {
  constexpr int kFrom = 40, kUntil = 120, kEnd = 150;  // no scans meanwhile, and 3 mg more on the accelerometer
  LioConfig aside = config();
  aside.init.hold_standstill = false;
  aside.map.insert_distance = 1e-6;  // so that the map has parts older than what comes
  TemporaryDirectory directory;
  LioSession session(aside, directory.file("out"), {});
  for (int i = 0; i < kEnd; ++i) {
    const TimeNs stamp = kStart + i * kScanStep;
    for (TimeNs t = stamp; t < stamp + kScanStep; t += kImuStep) {
      sensor_msgs::Imu message = at_rest(t);
      if (i >= kFrom && i < kUntil) message.linear_acceleration.x += 0.03;
      session.add(message);
    }
    if (i < kFrom || i >= kUntil) session.add(room(stamp));
    if (i < kUntil) {
      EXPECT_EQ(session.relocated(), "");
    }
  }
  session.end_of_data();
  session.finish("complete");
  const std::string told = session.relocated();
  ASSERT_EQ(told.find("at 1600000"), 0U) << told;
  EXPECT_GE(std::stod(told.substr(3)), 1e-9 * static_cast<double>(kStart + kUntil * kScanStep));
  EXPECT_NE(told.find("come back"), std::string::npos) << told;
  EXPECT_NE(told.find("(update/relocalize)"), std::string::npos) << told;
  std::vector<std::string> notes;
  for (const YAML::Node& note : YAML::LoadFile(directory.file("out/summary.yaml"))["notes"])
    notes.push_back(note.as<std::string>());
  EXPECT_EQ(std::count(notes.begin(), notes.end(), told + " (1 times in all)"), 1);
}

TEST(LioSession, a_disk_that_is_full_is_known_at_once_and_the_odometry_goes_on) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("out"));
  std::filesystem::create_symlink("/dev/full", directory.file("out/trajectory.tum"));
  std::size_t results = 0, results_without_trouble = 0;
  const std::string said = directory.file("out/trajectory.tum") + ": could not be written";
  LioSession session(config(), directory.file("out"), [&](const LioResult&) {
    ++results;
    if (session.output_trouble().empty()) ++results_without_trouble;
  });
  EXPECT_EQ(session.output_trouble(), "");
  for (int i = 0; i < kScans; ++i) {
    const TimeNs stamp = kStart + i * kScanStep;
    for (TimeNs t = stamp; t < stamp + kScanStep; t += kImuStep) session.add(at_rest(t));
    session.add(room(stamp));
  }
  session.end_of_data();
  EXPECT_EQ(results_without_trouble, 0U);
  EXPECT_GE(results + kLostAtTheStart, std::size_t{kScans});
  EXPECT_EQ(session.output_trouble().find(said), 0U) << session.output_trouble();
  try {
    session.finish("interrupted");
    FAIL() << "the lost trajectory is not said at the end";
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(std::string(error.what()).find(said), 0U) << error.what();
  }
}

}  // namespace
}  // namespace allan_lio
