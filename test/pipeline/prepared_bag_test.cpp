// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/ros/prepared_bag.h"

#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <filesystem>
#include <fstream>

#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/bag_reader.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

LioConfig simulated_config() {
  const std::string configs = std::string(ALLAN_LIO_SOURCE_DIR) + "/config";
  return read_config(load_yaml("simulated", {configs, configs + "/robots"}));
}

std::string refusal(const std::string& bag, const LioConfig& config, const std::string& truth = "") {
  try {
    prepare_bag({bag}, config, truth);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

void expect_text(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
}

/// A bag of samples and clouds of one's own, recorded 10 ms apart whatever their stamps.
class OwnBag {
 public:
  OwnBag() : bag_(path(), rosbag::bagmode::Write) {}
  void add_imu(double stamp) {
    sensor_msgs::Imu message;
    message.header.stamp = ros::Time(stamp);
    message.linear_acceleration.z = 9.8;
    bag_.write("/imu/data", now(), message);
  }
  void add_cloud(double stamp, std::uint32_t points = 0) {  // without fields
    sensor_msgs::PointCloud2 message;
    message.height = 1;
    message.width = points;
    message.point_step = 4;
    message.row_step = 4 * points;
    message.data.resize(message.row_step);
    message.header.stamp = ros::Time(stamp);
    bag_.write("/points", now(), message);
  }
  std::string close() {
    bag_.close();
    return path();
  }

 private:
  std::string path() const { return directory_.file("own.bag"); }
  ros::Time now() { return ros::Time(1000.0 + 0.01 * ++messages_); }

  TemporaryDirectory directory_;
  rosbag::Bag bag_;
  int messages_ = 0;
};

TEST(PreparedBag, TheFirstRunIsThatOfLioOfflineToTheBit) {
  const SimulatedBag& simulated = SimulatedBag::get();
  const TemporaryDirectory out;
  ASSERT_EQ(run_lio_offline(simulated.bag(), out.path(), "--param imu/k_ab=20").status, 0);
  const PreparedBag bag = prepare_bag({simulated.bag()}, simulated_config(), simulated.truth());
  EXPECT_EQ(bag.record.scans(), static_cast<std::size_t>(SimulatedBag::kScans));
  EXPECT_EQ(bag.record.imu().size(), static_cast<std::size_t>(SimulatedBag::kImuSamples));
  ASSERT_EQ(bag.notes.size(), 1U);
  expect_text(bag.notes[0], {"point time"});
  std::string trajectory;
  NoiseTrial trial;
  trial.setting.imu.k_ab = 20.0;
  const TrialResult result = run_trial(bag.record, simulated_config(), trial, 1, [&trajectory](const LioResult& state) {
    trajectory += format_tum_line({state.state.nav.stamp, state.state.nav.T_world_imu}) + "\n";
  });
  EXPECT_EQ(trajectory, contents_of(out.file("trajectory.tum")));
  const TrajectoryError error =
      evaluate_trajectory(read_tum(simulated.truth()), read_tum(out.file("trajectory.tum")), Alignment::kSe3);
  EXPECT_NEAR(result.ate, error.translation.rmse, 1e-12);
}

TEST(PreparedBag, ABagThatIsCutOffGivesWhatThereIsAndSaysSo) {
  const TemporaryDirectory directory;
  const std::string cut = directory.file("cut.bag");
  std::filesystem::copy_file(SimulatedBag::get().bag(), cut);
  std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
  const PreparedBag bag = prepare_bag({cut}, simulated_config(), SimulatedBag::get().truth());
  EXPECT_GT(bag.record.scans(), 50U);
  EXPECT_LT(bag.record.scans(), 150U);
  ASSERT_EQ(bag.notes.size(), 2U);
  expect_text(bag.notes[1], {"cut.bag"});
}

TEST(PreparedBag, AMissingTopicIsNamed) {
  LioConfig config = simulated_config();
  config.topics.lidar = "/velodyne_points";
  expect_text(refusal(SimulatedBag::get().bag(), config), {"/velodyne_points", "/points"});
}

TEST(PreparedBag, ATruthOfAnotherTimeOrNoneIsRefusedByName) {
  const TemporaryDirectory directory;
  const std::string other = directory.file("other.tum"), garbage = directory.file("garbage.tum");
  std::ofstream(other) << "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 1 0 0 0 0 1\n";
  std::ofstream(garbage) << "no numbers\n";
  const std::string& bag = SimulatedBag::get().bag();
  expect_text(refusal(bag, simulated_config(), other), {"other.tum", "rooms.bag", "no pose"});
  expect_text(refusal(bag, simulated_config(), garbage), {"garbage.tum:1"});
}

TEST(PreparedBag, CloudsThatCannotBeDecodedAreToldOf) {
  OwnBag own;
  own.add_imu(1000.0);
  for (int i = 0; i < 60; ++i) own.add_cloud(1000.0 + 0.1 * i, 100);
  expect_text(refusal(own.close(), simulated_config()), {"own.bag", "no cloud could be decoded: "});
}

TEST(PreparedBag, ARecordingThatBeginsAnewIsRefusedButSomeLateSamplesAreNot) {
  const std::string anew = "more than one recording";
  for (const int late : {9, 10}) {
    OwnBag own;
    for (int i = 0; i < 300; ++i) own.add_imu(1000.0 + 0.01 * i);
    for (int i = 0; i < late; ++i) own.add_imu(1000.0 + 0.01 * i);
    own.add_imu(1003.0);
    own.add_cloud(1003.0);
    const std::string text = refusal(own.close(), simulated_config());
    EXPECT_EQ(text.find(anew) != std::string::npos, late == 10) << text;
  }
}

TEST(PreparedBag, ReadingCanBeStopped) {
  double last = -1.0;
  const GoOn until_half = [&last](double part) {
    EXPECT_GE(part, last);
    last = part;
    return part < 0.5;
  };
  EXPECT_THROW(prepare_bag({SimulatedBag::get().bag()}, simulated_config(), "", until_half), BagError);
  EXPECT_GE(last, 0.5);
  EXPECT_LT(last, 0.6);
}

}  // namespace
}  // namespace allan_lio
