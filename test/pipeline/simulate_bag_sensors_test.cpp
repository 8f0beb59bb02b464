// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>

#include "child_process.h"
#include "shared_data.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

class SimulateBagSensors : public ::testing::Test {
 protected:
  Outcome run(const std::string& name, const std::string& more) const {
    return run_tool("simulate_bag --scene rooms --duration 1 --out " + directory_.file(name + ".bag") + " " + more);
  }
  std::string bytes(const std::string& name) const { return contents_of(directory_.file(name)); }

  TemporaryDirectory directory_;
};

TEST_F(SimulateBagSensors, TheSameSeedGivesTheSameBagWhateverTheThreads) {
  const std::string errors = "--lidar livox_mid360 --imu-errors real,dropped_samples=2% --lidar-effects real ";
  ASSERT_EQ(run("one", errors + "--threads 1").status, 0);
  ASSERT_EQ(run("two", errors + "--threads 2").status, 0);
  ASSERT_EQ(run("other", errors + "--seed 2").status, 0);
  ASSERT_EQ(run("plain", "--lidar livox_mid360").status, 0);
  EXPECT_EQ(bytes("one.bag"), bytes("two.bag"));
  EXPECT_EQ(bytes("one_truth.csv"), bytes("two_truth.csv"));
  EXPECT_NE(bytes("one.bag"), bytes("other.bag"));
  EXPECT_NE(bytes("one.bag"), bytes("plain.bag"));
}

TEST_F(SimulateBagSensors, WhatIsInForceIsToldAndKeptBesideTheBag) {
  const Outcome outcome = run("a", "--imu-errors clock_offset=2ms --lidar-effects quantization=5mm");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("LiDAR effects: quantization=0.005m\n"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("IMU errors besides noise and bias: clock_offset=0.002s\n"), std::string::npos);
  EXPECT_NE(bytes("a_sensors.yaml").find("clock_offset: 0.002  # [s]"), std::string::npos);
}

TEST_F(SimulateBagSensors, ARealImuTakesThePlaceOfTheSimulatedOne) {
  const std::string folder = shared_data("euroc_v1_01");
  if (folder.empty()) GTEST_SKIP() << "the shared data are not here";
  const std::string record = "--imu-csv " + folder + "/imu.csv --trajectory " + folder + "/truth.tum";
  const Outcome outcome =
      run_tool("simulate_bag --scene city --duration 2 --out " + directory_.file("real.bag") + " " + record);
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("400 IMU samples"), std::string::npos) << outcome.text;
  EXPECT_EQ(bytes("real.tum").substr(0, 20), "1403715273.262142976");
  EXPECT_FALSE(std::filesystem::exists(directory_.file("real_truth.csv"))) << "nobody knows its biases";
  EXPECT_NE(run("a", record + " --imu-errors real").status, 0);
}

TEST_F(SimulateBagSensors, MistakesAreOneLineEach) {
  const auto refused = [&](const std::string& option, const std::string& part) {
    const Outcome outcome = run("x", option);
    EXPECT_GT(outcome.status, 0) << option;
    EXPECT_NE(outcome.text.find(part), std::string::npos) << outcome.text;
    EXPECT_FALSE(std::filesystem::exists(directory_.file("x.bag"))) << option;
  };
  refused("--imu-errors scale=1", "'scale=1' is no error of an IMU");
  refused("--imu-errors clock_offset=1", "the unit is missing");
  refused("--lidar-effects mixed_pixels=0.5", "needs a divergence");
  refused("--imu-csv x.csv", "needs the way that it went");
}

}  // namespace
}  // namespace allan_lio
