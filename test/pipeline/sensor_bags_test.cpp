// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/ros/bag_source.h"
#include "allan_lio/ros/conversions.h"
#include "allan_lio/ros/decode_cloud.h"
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

TEST(SensorBags, HesaiInSecondsOfTheClock) {
  const DriverRun run({{}, [](sensor_msgs::PointCloud2& cloud) {
                         cloud = in_layout(cloud, layout_of("hesai"), cloud.header.stamp.toSec(), 1.0);
                         return true;
                       }});
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  EXPECT_TRUE(run.says("float64 in s of the clock")) << run.outcome.text;
}

TEST(SensorBags, RoboSenseInSecondsOfTheClockStampedAtTheEnd) {
  const DriverRun run({{}, [](sensor_msgs::PointCloud2& cloud) {
                         cloud = in_layout(cloud, layout_of("robosense"), cloud.header.stamp.toSec(), 1.0);
                         cloud.header.stamp += ros::Duration(0.1);
                         return true;
                       }});
  ASSERT_EQ(run.outcome.status, 0) << run.outcome.text;
  EXPECT_LT(run.ate, kAteBound);
  EXPECT_TRUE(run.says("float64 in s of the clock")) << run.outcome.text;
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

struct Unit {
  const char* name;
  double per_second;
};
constexpr Unit kUnits[] = {{"s", 1.0}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}};
constexpr std::uint8_t kTimeTypes[] = {sensor_msgs::PointField::FLOAT32, sensor_msgs::PointField::FLOAT64,
                                       sensor_msgs::PointField::UINT32, kUint64Code};
constexpr int kRays = 512;      // 8 columns of 64 beams
constexpr double kSweep = 0.1;  // [s]

/// A sweep whose points' times grow with x: 1 m a sweep.
sensor_msgs::PointCloud2 short_sweep(const FixtureLayout& layout, std::uint8_t time_type, const Unit& unit,
                                     TimeNs stamp) {
  std::vector<FixturePoint> points;
  for (int i = 0; i < kRays; ++i) {
    const double part = static_cast<double>(i) / (kRays - 1);
    points.push_back({2.0F + static_cast<float>(part), 1.0F, 0.5F, 9.0F, kSweep * part * unit.per_second});
  }
  return make_cloud(layout, time_type, stamp, points);
}

/// What the bag's only topic decodes to, one a message.
std::vector<DecodedCloud> decode_bag(const std::string& bag) {
  LioConfig::Lidar lidar{};
  lidar.deskew = true;
  lidar.max_range = 100.0;
  CloudDecoder decoder(lidar);
  BagSource source({bag});
  std::vector<DecodedCloud> decoded;
  for (BagMessage message; source.next(message);) decoded.push_back(decoder.decode(to_raw_cloud(message)));
  return decoded;
}

void expect_out_as_in(const std::string& bag, const FixtureLayout& layout, std::uint8_t type, const Unit& unit) {
  constexpr TimeNs kStamp = 1600000000 * kNsPerSecond;
  rosbag::Bag out(bag, rosbag::bagmode::Write);
  for (int i = 0; i < 2; ++i) {
    const auto cloud = short_sweep(layout, type, unit, kStamp + i * kNsPerSecond / 10);
    out.write("/points", cloud.header.stamp, cloud);
  }
  out.close();
  const bool integer = type == sensor_msgs::PointField::UINT32 || type == kUint64Code;
  const bool too_coarse = integer && unit.per_second == 1.0;
  const double tolerance = 30.0 + (integer ? 1e9 / unit.per_second : 0.0);  // [ns], of x and of the time
  const std::vector<DecodedCloud> decoded = decode_bag(bag);
  ASSERT_EQ(decoded.size(), 2U);
  for (const DecodedCloud& cloud : decoded) {
    ASSERT_EQ(cloud.scan.has_value(), !too_coarse) << cloud.error;
    if (!cloud.scan) continue;
    ASSERT_EQ(cloud.scan->points.size(), std::size_t{kRays});
    for (const ScanPoint& p : cloud.scan->points) ASSERT_NEAR(p.offset_ns, 1e9 * kSweep * (p.x - 2.0), tolerance);
  }
}

TEST(SensorBags, EveryLayoutTimeTypeAndUnitComesOutOfABagAsItWentIn) {
  const TemporaryDirectory directory;
  for (const FixtureLayout& layout : driver_layouts()) {
    for (const std::uint8_t type : kTimeTypes) {
      for (const Unit& unit : kUnits) {
        SCOPED_TRACE(layout.driver + ", type " + std::to_string(type) + ", " + unit.name);
        expect_out_as_in(directory.file("short.bag"), layout, type, unit);
      }
    }
  }
}

}  // namespace
}  // namespace allan_lio
