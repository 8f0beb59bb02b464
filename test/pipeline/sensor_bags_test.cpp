// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/tum.h"
#include "changed_bag.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

constexpr double kAteBound = 0.015;   // [m], that of lio_offline_test
constexpr double kGravity = 9.80665;  // [m/s^2]

/// lio_offline on the simulated bag as another sensor's driver would have recorded it.
struct DriverRun {
  explicit DriverRun(const BagChange& change) {
    change_bag(SimulatedBag::get().bag(), directory.file("driver.bag"), change);
    outcome = run_lio_offline(directory.file("driver.bag"), directory.file("results"));
    if (outcome.status != 0) return;
    ate = evaluate_trajectory(read_tum(SimulatedBag::get().truth()), read_tum(directory.file("results/trajectory.tum")),
                              Alignment::kSe3)
              .translation.rmse;
  }
  bool says(const std::string& words) const { return outcome.text.find(words) != std::string::npos; }

  TemporaryDirectory directory;
  Outcome outcome;
  double ate = 1e9;  // [m]
};

bool to_g(sensor_msgs::Imu& imu) {
  imu.linear_acceleration.x /= kGravity;
  imu.linear_acceleration.y /= kGravity;
  imu.linear_acceleration.z /= kGravity;
  return true;
}

TEST(SensorBags, LivoxCustomMsgWithAnImuInG) {
  BagChange change;
  change.livox_custom = true;
  change.imu = to_g;
  const DriverRun run(change);
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  EXPECT_TRUE(run.says("200 of 200 scans used")) << run.outcome.text;
  EXPECT_TRUE(run.says("accelerometer: reads in g, taken times 9.80665")) << run.outcome.text;
}

TEST(SensorBags, OusterWithAnImuInMetresPerSecondSquared) {
  const DriverRun run({{}, [](sensor_msgs::PointCloud2& cloud) {
                         cloud = in_layout(cloud, layout_of("ouster"), 0.0, 1e9);
                         return true;
                       }});
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  EXPECT_TRUE(run.says("accelerometer: reads in m/s^2")) << run.outcome.text;
}

TEST(SensorBags, LivoxPointCloud2InNanosecondsOfTheClock) {
  const DriverRun run({{}, [](sensor_msgs::PointCloud2& cloud) {
                         cloud = in_layout(cloud, layout_of("livox"), 1e9 * cloud.header.stamp.toSec(), 1e9);
                         return true;
                       }});
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  EXPECT_TRUE(run.says("float64 in ns of the clock")) << run.outcome.text;
}

TEST(SensorBags, FramesThatChangeOrAreEmptyAreToldOnceAndNothingElseHappens) {
  int count = 0;
  const DriverRun run({{}, [&](sensor_msgs::PointCloud2& cloud) {
                         cloud.header.frame_id = ++count % 3 == 0 ? "" : count % 3 == 1 ? "lidar" : "other";
                         return true;
                       }});
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  const std::string change = "change their frame_id from 'lidar' to 'other'";
  const std::size_t first = run.outcome.text.find(change);
  ASSERT_NE(first, std::string::npos) << run.outcome.text;
  EXPECT_EQ(run.outcome.text.find(change, first + 1), std::string::npos) << run.outcome.text;
  EXPECT_TRUE(run.says("the LiDAR's messages have an empty frame_id")) << run.outcome.text;
}

}  // namespace
}  // namespace allan_lio
