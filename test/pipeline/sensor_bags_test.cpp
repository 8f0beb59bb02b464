// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <rosbag/bag.h>

#include <cmath>
#include <iterator>
#include <map>

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

constexpr std::size_t kRays = 512;  // 8 columns of 64 beams
// Of seconds that a double holds as they are, and so does the fixture.
constexpr TimeNs kStamps[] = {kFixtureStamp, kFixtureStamp + kNsPerSecond / 8};

/// One unit and anchor of a point time; a bag holds each as a topic.
struct TimeTopic {
  std::string name;
  FixtureUnit unit;
  FixtureAnchor anchor;
};

std::vector<TimeTopic> time_topics() {
  std::vector<TimeTopic> topics;
  for (const FixtureUnit& unit : fixture_units())
    for (const FixtureAnchor& anchor : fixture_anchors())
      topics.push_back({"/points_" + std::to_string(topics.size()), unit, anchor});
  return topics;
}

/// A sweep at each of kStamps in every topic.
void write_sweeps(const std::string& file, const FixtureLayout& layout, std::uint8_t type) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  for (const TimeTopic& topic : time_topics()) {
    for (const TimeNs stamp : kStamps) {
      const auto points = sweep_points(kRays, topic.anchor.zero(stamp), topic.unit.per_second);
      bag.write(topic.name, to_ros_time(stamp), make_cloud(layout, type, stamp, points));
    }
  }
}

/// What the messages of each topic decode to.
std::map<std::string, std::vector<DecodedCloud>> decode_bag(const std::string& file) {
  std::map<std::string, CloudDecoder> decoders;
  for (const TimeTopic& topic : time_topics()) {
    LioConfig::Lidar lidar{};
    lidar.deskew = true;
    lidar.point_time = topic.anchor.told;
    lidar.max_range = 100.0;
    decoders.emplace(topic.name, lidar);
  }
  BagSource source({file});
  std::map<std::string, std::vector<DecodedCloud>> decoded;
  for (BagMessage message; source.next(message);) {
    const std::string& topic = message.connection->topic;
    decoded[topic].push_back(decoders.at(topic).decode(to_raw_cloud(message)));
  }
  return decoded;
}

void expect_out_as_in(const DecodedCloud& decoded, const TimeTopic& topic, std::uint8_t type, TimeNs stamp) {
  ASSERT_EQ(decoded.scan.has_value(), holds(type, topic.unit, topic.anchor, stamp)) << decoded.error;
  if (!decoded.scan) return;
  EXPECT_EQ(decoded.scan->stamp, stamp);
  ASSERT_EQ(decoded.scan->points.size(), kRays);
  const double largest = std::abs(topic.anchor.zero(stamp)) + kFixtureSweep;
  const double tolerance = 1.0 + 1e9 * time_step(type, topic.unit, largest);  // [ns]
  for (std::size_t i = 0; i < kRays; ++i)
    ASSERT_NEAR(decoded.scan->points[i].offset_ns, 1e9 * (topic.anchor.begin + kFixtureSweep * sweep_part(i, kRays)),
                tolerance);
}

TEST(SensorBags, EveryLayoutTimeTypeUnitAndAnchorComesOutOfABagAsItWentIn) {
  const TemporaryDirectory directory;
  const std::string bag = directory.file("short.bag");
  for (const FixtureLayout& layout : driver_layouts()) {
    for (const std::uint8_t type : fixture_time_types()) {
      write_sweeps(bag, layout, type);
      const auto decoded = decode_bag(bag);
      for (const TimeTopic& topic : time_topics()) {
        SCOPED_TRACE(layout.driver + ", type " + std::to_string(type) + ", " + topic.unit.name + " " +
                     topic.anchor.name);
        ASSERT_EQ(decoded.count(topic.name), 1U);
        ASSERT_EQ(decoded.at(topic.name).size(), std::size(kStamps));
        for (std::size_t i = 0; i < std::size(kStamps); ++i)
          expect_out_as_in(decoded.at(topic.name)[i], topic, type, kStamps[i]);
      }
    }
  }
}

}  // namespace
}  // namespace allan_lio
