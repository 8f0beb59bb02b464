// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "allan_lio/io/tum.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

constexpr int kScansCopied = 60;  ///< more than what is given up after when none can be decoded

/// The simulated bag's first scans; the IMU too if `imu`, the points' times too if `times`.
void copy_bag(const std::string& to, bool imu, bool times) {
  rosbag::Bag in(SimulatedBag::get().bag(), rosbag::bagmode::Read);
  rosbag::Bag out(to, rosbag::bagmode::Write);
  int scans = 0;
  for (const rosbag::MessageInstance& message : rosbag::View(in)) {
    if (auto sample = message.instantiate<sensor_msgs::Imu>()) {
      if (imu) out.write(message.getTopic(), message.getTime(), *sample);
    } else if (auto cloud = message.instantiate<sensor_msgs::PointCloud2>()) {
      auto& fields = cloud->fields;
      const auto is_time = [](const sensor_msgs::PointField& field) { return field.name == "time"; };
      if (!times) fields.erase(std::remove_if(fields.begin(), fields.end(), is_time), fields.end());
      out.write(message.getTopic(), message.getTime(), *cloud);
      if (++scans == kScansCopied) break;
    }
  }
  out.close();
}

class BadInput : public ::testing::Test {
 protected:
  /// Non-zero exit, and a sentence that names the culprit.
  static void expect_refusal(const Outcome& outcome, const std::string& sentence) {
    EXPECT_GT(outcome.status, 0) << outcome.text;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << "'" << sentence << "' is not in: " << outcome.text;
  }

  /// Runs the simulated bag with a configuration of one's own.
  Outcome run_with(const std::string& yaml) const {
    const std::string file = directory_.file("robot.yaml");
    std::ofstream(file) << yaml;
    return run_tool("lio_offline --bag " + SimulatedBag::get().bag() + " --config " + file + " --out " + out_);
  }

  TemporaryDirectory directory_;
  std::string out_ = directory_.file("out");
};

TEST_F(BadInput, ABagWithoutItsImuTopicIsRefusedByTheTopicsName) {
  const std::string bag = directory_.file("no_imu.bag");
  copy_bag(bag, false, true);
  expect_refusal(run_lio_offline(bag, out_), "the bag holds no topic /imu/data");
  expect_refusal(run_lio_offline(SimulatedBag::get().bag(), out_, "--param topics/lidar=/velodyne"),
                 "no topic /velodyne; its topics of type sensor_msgs/PointCloud2: /points");
}

TEST_F(BadInput, AMessageThatWasRecordedInAnotherCenturyCostsNoOther) {
  const std::string bag = directory_.file("wild.bag");
  copy_bag(bag, true, true);
  {
    rosbag::Bag more(bag, rosbag::bagmode::Append);
    sensor_msgs::Imu imu;
    imu.header.stamp = ros::Time(0xffffffffU, 5);
    more.write("/imu/data", imu.header.stamp, imu);
  }
  const Outcome run = run_lio_offline(bag, out_);
  EXPECT_EQ(run.status, 0) << run.text;
  EXPECT_NE(run.text.find("60 of 60 scans used"), std::string::npos) << run.text;
  const Outcome check = run_tool("check_bag " + bag);
  EXPECT_NE(check.text.find("/points"), std::string::npos) << check.text;
  EXPECT_EQ(check.text.find("out of dual 32-bit range"), std::string::npos) << check.text;
}

TEST_F(BadInput, CloudsWithoutPointTimesAreRefusedUnlessDeskewIsTurnedOff) {
  const std::string bag = directory_.file("no_time.bag");
  copy_bag(bag, true, false);
  expect_refusal(run_lio_offline(bag, out_), "no field for the points' times (fields: x, y, z, intensity, ring)");
  EXPECT_NE(YAML::LoadFile(out_ + "/summary.yaml")["status"].as<std::string>().find("incomplete"), std::string::npos);

  const Outcome accepted = run_lio_offline(bag, out_, "--param lidar/deskew=false");
  EXPECT_EQ(accepted.status, 0) << accepted.text;
  EXPECT_NE(accepted.text.find("60 of 60 scans used"), std::string::npos) << accepted.text;
}

TEST_F(BadInput, CloudsWithoutPointTimesHaveThemFromTheAzimuthWhereThatIsChosen) {
  const std::string bag = directory_.file("no_time.bag"), with_times = directory_.file("time.bag");
  const std::string timed_out = directory_.file("timed");
  copy_bag(bag, true, false);
  copy_bag(with_times, true, true);
  ASSERT_EQ(run_lio_offline(with_times, timed_out).status, 0);
  const auto farthest_apart = [&](const std::string& parameter) {
    const Outcome run = run_lio_offline(bag, out_, "--param " + parameter);
    EXPECT_EQ(run.status, 0) << run.text;
    const Trajectory timed = read_tum(timed_out + "/trajectory.tum"), other = read_tum(out_ + "/trajectory.tum");
    EXPECT_EQ(timed.size(), other.size());
    double apart = 0.0;
    for (std::size_t i = 0; i < std::min(timed.size(), other.size()); ++i)
      apart = std::max(apart, (timed[i].pose.translation - other[i].pose.translation).norm());
    return apart;
  };
  const double made = farthest_apart("lidar/point_time=azimuth_clockwise");
  EXPECT_LT(made, 0.005) << "against " << farthest_apart("lidar/deskew=false") << " without times";
  const Outcome wrong = run_lio_offline(bag, out_, "--param lidar/point_time=azimuth_counterclockwise");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_NE(wrong.text.find("not in the order of firing"), std::string::npos) << wrong.text;
}

TEST_F(BadInput, OfABagThatIsCutOffWhatThereIsIsComputed) {
  const std::string cut = directory_.file("cut.bag"), whole_out = directory_.file("whole");
  const std::string bytes = contents_of(SimulatedBag::get().bag());
  std::ofstream(cut, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size() * 6 / 10));
  ASSERT_EQ(run_lio_offline(SimulatedBag::get().bag(), whole_out).status, 0);
  expect_refusal(run_lio_offline(cut, out_), "cut.bag has no usable index");

  for (const char* file : {"/trajectory.tum", "/states.csv"}) {
    const std::string whole = contents_of(whole_out + file), part = contents_of(out_ + file);
    EXPECT_GT(part.size(), whole.size() / 2) << file;
    EXPECT_LT(part.size(), whole.size()) << file;
    EXPECT_EQ(part.back(), '\n') << file;
    EXPECT_TRUE(whole.compare(0, part.size(), part) == 0) << file << " does not begin as the whole bag's";
  }
  const YAML::Node summary = YAML::LoadFile(out_ + "/summary.yaml");
  EXPECT_EQ(summary["status"].as<std::string>().rfind("incomplete: ", 0), 0U) << summary["status"];
  const std::string rows = contents_of(out_ + "/trajectory.tum");
  EXPECT_EQ(summary["scans"]["used"].as<int>(), std::count(rows.begin(), rows.end(), '\n'));
}

TEST_F(BadInput, WhatIsNoBagIsRefusedByName) {
  const std::string text = directory_.file("text.bag");
  std::ofstream(text) << "this is a text that is long enough not to be too short for a bag";
  expect_refusal(run_lio_offline(text, out_), text + " is not a bag");
  expect_refusal(run_lio_offline(directory_.file("absent.bag"), out_), "absent.bag");
}

TEST_F(BadInput, AConfigurationIsRefusedByKeyValueAndLine) {
  const std::string base = "include: [robots/simulated]\n";
  expect_refusal(run_with(base + "imu: {k_bg: 2}\n"), "'imu/k_bg'");
  expect_refusal(run_with(base + "lidar: {leaff: 0.3}\n"), "the nearest one is 'lidar/leaf'");
  expect_refusal(run_with(base + "imu: {k_gb: -2}\n"), "imu/k_gb = '-2'");
  expect_refusal(run_with(base + "imu: {k_gb: -2}\n"), "robot.yaml:2");
  expect_refusal(run_with(base + "lidar: {range_noise: .nan}\n"), "lidar/range_noise = '.nan'");
  expect_refusal(run_with(base + "extrinsics: {T_imu_lidar: {translation: [0, 1]}}\n"),
                 "extrinsics/T_imu_lidar/translation");
  expect_refusal(run_with("topics: {imu: /imu/data}\n"), "imu/noise/");
  expect_refusal(run_with("include: [imu/nosuch]\n"), "imu/nosuch");
  EXPECT_EQ(run_with(base).status, 0) << "all of these differ from a good one by one line";
}

TEST_F(BadInput, AMissingConfigurationIsNamed) {
  const std::string command = "lio_offline --bag " + SimulatedBag::get().bag() + " --out " + out_ + " --config ";
  expect_refusal(run_tool(command + "nosuch"), "configuration 'nosuch' is not found");
  expect_refusal(run_tool(command + "/nowhere/robot.yaml"), "/nowhere/robot.yaml");
}

TEST_F(BadInput, AParameterThatNobodyKnowsNamesTheNearest) {
  const std::string bag = SimulatedBag::get().bag();
  expect_refusal(run_lio_offline(bag, out_, "--param map/voxelsize=1"), "the nearest one is 'map/voxel_size'");
  expect_refusal(run_lio_offline(bag, out_, "--param map/voxel_size"), "map/voxel_size");
  expect_refusal(run_lio_offline(bag, out_, "--threads 0"), "--threads");
}

TEST_F(BadInput, AnOutputThatCannotBeWrittenIsNamedBeforeTheRun) {
  const Outcome outcome = run_lio_offline(SimulatedBag::get().bag(), "/dev/null/out");
  expect_refusal(outcome, "/dev/null/out: cannot be created");
  EXPECT_EQ(outcome.text.find("scans used"), std::string::npos) << outcome.text;
}

TEST_F(BadInput, TheSimulatorNamesWhatItKnows) {
  const std::string to = " --out " + directory_.file("x.bag");
  expect_refusal(run_tool("simulate_bag --scene moon" + to), "no scene 'moon'; there are rooms, corridor, tunnel");
  expect_refusal(run_tool("simulate_bag --scene rooms --lidar eye" + to), "'eye'");
  expect_refusal(run_tool("simulate_bag --scene rooms --imu none" + to), "'none'");
  expect_refusal(run_tool("simulate_bag --scene rooms --duration -1" + to), "--duration");
  expect_refusal(run_tool("simulate_bag --scene rooms --out " + directory_.file("x.txt")), "does not end in .bag");
  expect_refusal(run_tool("simulate_bag --scene rooms --duration 1 --out /dev/null/x.bag"), "/dev/null/x.bag");
}

}  // namespace
}  // namespace allan_lio
