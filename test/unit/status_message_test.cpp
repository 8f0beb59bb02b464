// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Every field has a value of its own, so that none can stand in another's place.
#include "allan_lio/ros/status_message.h"

#include <gtest/gtest.h>

#include <map>

#include "allan_lio/io/config_source.h"
#include "allan_lio/ros/conversions.h"
#include "simulated_drive.h"

namespace allan_lio {
namespace {

constexpr TimeNs kStart = 1600000000 * kNsPerSecond;
constexpr TimeNs kImuStep = 5'000'000;     // [ns]
constexpr TimeNs kScanStep = 100'000'000;  // [ns]
constexpr double kDelay = 0.0625;          // [s]
const LostOnTheWay kLost{8, 9};

LioConfig configuration() {
  LioConfig config = simulated_robot();
  config.lidar.deskew = false;  // the clouds have no time
  config.frames.odom = "some_odom";
  config.map.max_mb = 321.0;
  config.imu.scale.k_g = 1.25;
  config.imu.scale.k_a = 1.5;
  config.imu.scale.k_gb = 1.75;
  config.imu.scale.k_ab = 2.25;
  config.lidar.k_r = 2.5;
  return config;
}

sensor_msgs::Imu at_rest(TimeNs stamp, double gravity = 9.80665) {
  sensor_msgs::Imu message;
  message.header.stamp = to_ros_time(stamp);
  message.linear_acceleration.z = gravity;
  return message;
}

/// A floor and two walls.
sensor_msgs::PointCloud2 corner(TimeNs stamp) {
  std::vector<WorldPoint> points;
  for (float a = -3.9F; a < 4.0F; a += 0.25F)
    for (float b = -3.9F; b < 4.0F; b += 0.25F)
      points.insert(points.end(), {{a, b, -1.0F, 1.0F}, {a, 4.0F, b, 1.0F}, {4.0F, a, b, 1.0F}});
  return *to_cloud(points, "lidar", stamp);
}

/// A session that has a map, and has lost messages in four ways, each another number of times.
struct LossySession {
  LioSession session{configuration(), "", {}};

  LossySession() {
    for (int i = 0; i < 5; ++i) {
      const TimeNs stamp = kStart + i * kScanStep;
      for (TimeNs t = stamp; t < stamp + kScanStep; t += kImuStep) session.add(at_rest(t));
      session.add(corner(stamp));
    }
    for (int i = 0; i < 3; ++i) session.add(at_rest(kStart + 5 * kScanStep + i * kImuStep, 1e5));
    for (int i = 0; i < 4; ++i) session.add(at_rest(kStart + 4 * kScanStep));
    session.add(corner(kStart));
    for (int i = 0; i < 6; ++i) session.count_undecodable("why not");
    session.end_of_data();
  }
};

LioResult result() {
  LioResult result;
  result.outcome = ScanOutcome::kTooFewMatches;
  result.state.nav.stamp = kStart + 123'456'789;
  result.state.nav.gyro_bias = {0.01, 0.02, 0.03};
  result.state.nav.accel_bias = {0.4, 0.5, 0.6};
  for (int i = 0; i < kLioDof; ++i) result.covariance(i, i) = (i + 1.0) * (i + 1.0);
  result.points = 30000;
  result.registered = 2000;
  result.inliers = 1500;
  result.residual_rms = 0.0375;
  result.innovation.nis = 7.5;
  result.innovation.dof = 5;
  result.localizability.probability << 0.1, 0.2, 0.3, 0.6, 0.7, 0.8;
  result.localizability.support << 0.05, 0.15, 0.25, 0.45, 0.55, 0.65;
  return result;
}

HealthWindow window() {
  HealthWindow window;
  for (int i = 0; i < 20; ++i) {
    LioResult scan = result();
    scan.innovation = {};
    scan.innovation.nis = 12.0;
    scan.innovation.dof = 6;
    window.add(scan, 0.003);
  }
  return window;
}

void expect_vector(const geometry_msgs::Vector3& vector, double x, double y, double z) {
  EXPECT_DOUBLE_EQ(vector.x, x);
  EXPECT_DOUBLE_EQ(vector.y, y);
  EXPECT_DOUBLE_EQ(vector.z, z);
}

class StatusMessage : public ::testing::Test {
 protected:
  LossySession lossy_;
  HealthWindow window_ = window();
  StatusPtr message_ = to_status_message(result(), lossy_.session, window_, kLost, kDelay);
};

TEST_F(StatusMessage, HoldsWhatBecameOfTheScan) {
  EXPECT_EQ(to_time_ns(message_->header.stamp), kStart + 123'456'789);
  EXPECT_EQ(message_->header.frame_id, "some_odom");
  EXPECT_EQ(message_->outcome, 3);
  EXPECT_EQ(message_->points, 30000U);
  EXPECT_EQ(message_->registered, 2000U);
  EXPECT_EQ(message_->inliers, 1500U);
  EXPECT_EQ(message_->residual_rms, 0.0375);
  EXPECT_EQ(message_->nis, 7.5);
  EXPECT_EQ(message_->nis_dof, 5U);
  EXPECT_EQ(message_->delay, kDelay);
}

TEST_F(StatusMessage, HoldsTheSixDirectionsInTheirOrder) {
  const double probability[6] = {0.1, 0.2, 0.3, 0.6, 0.7, 0.8}, support[6] = {0.05, 0.15, 0.25, 0.45, 0.55, 0.65};
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(message_->probability[i], probability[i]) << i;
    EXPECT_EQ(message_->support[i], support[i]) << i;
  }
  EXPECT_EQ(message_->weak_axes, 4U) << "with less than half of the support, not of the probability";
}

TEST_F(StatusMessage, HoldsTheWindowsMeanAndBand) {
  EXPECT_EQ(message_->nis_scans, 20U);
  EXPECT_DOUBLE_EQ(message_->nis_mean, 2.0);
  // chi^2 of 120 degrees of freedom: 95 % between 91.573 and 152.211 (tables).
  EXPECT_NEAR(120 * message_->nis_low, 91.573, 0.1);
  EXPECT_NEAR(120 * message_->nis_high, 152.211, 0.1);
  EXPECT_DOUBLE_EQ(message_->scan_time_mean, 0.003);
}

TEST_F(StatusMessage, HoldsBothBiasesWithTheirOwnSigmas) {
  expect_vector(message_->gyro_bias, 0.01, 0.02, 0.03);
  expect_vector(message_->accel_bias, 0.4, 0.5, 0.6);
  expect_vector(message_->gyro_bias_sigma, kGyroBias + 1, kGyroBias + 2, kGyroBias + 3);
  expect_vector(message_->accel_bias_sigma, kAccelBias + 1, kAccelBias + 2, kAccelBias + 3);
}

TEST_F(StatusMessage, HoldsTheMapAndTheScansTime) {
  const LioSession& session = lossy_.session;
  EXPECT_GT(message_->map_mb, 0.0);
  EXPECT_EQ(message_->map_mb, session.odometry().map_megabytes());
  EXPECT_EQ(message_->map_max_mb, 321.0);
  EXPECT_GT(message_->map_voxels, 0U);
  EXPECT_EQ(message_->map_voxels, session.odometry().map_voxels());
  EXPECT_GT(message_->scan_time, 0.0);
  EXPECT_EQ(message_->scan_time, session.scan_seconds());
}

TEST_F(StatusMessage, HoldsEveryLossByItsReason) {
  std::map<std::string, std::uint64_t> dropped;
  for (const Count& count : message_->dropped) dropped[count.reason] = count.count;
  EXPECT_EQ(dropped["clouds: undecodable"], 6U);
  EXPECT_EQ(dropped["scans: not_newer_than_the_last"], 1U);
  EXPECT_EQ(dropped["imu: dropped_not_newer"], 4U);
  EXPECT_EQ(dropped["imu: dropped_invalid"], 3U);
  EXPECT_EQ(dropped["imu: lost_before_arrival"], 8U);
  EXPECT_EQ(dropped["scans: lost_before_arrival"], 9U);
  EXPECT_EQ(dropped.size(), count_losses(lossy_.session.odometry().counters(), 6, kLost).size());
}

TEST_F(StatusMessage, HoldsTheMultipliersInForceAndTheConfigurationsHash) {
  EXPECT_EQ(message_->k_g, 1.25);
  EXPECT_EQ(message_->k_a, 1.5);
  EXPECT_EQ(message_->k_gb, 1.75);
  EXPECT_EQ(message_->k_ab, 2.25);
  EXPECT_EQ(message_->k_r, 2.5);
  EXPECT_EQ(message_->config_hash, config_hash(configuration()));
}

}  // namespace
}  // namespace allan_lio
