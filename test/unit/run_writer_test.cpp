// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/io/run_writer.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "allan_lio/io/config_source.h"
#include "allan_lio/io/tum.h"
#include "allan_lio/math/so3.h"

namespace allan_lio {
namespace {

/// A directory of its own for each test, gone afterwards.
class RunWriterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "allan_lio_run_XXXXXX";
    ASSERT_NE(mkdtemp(&pattern[0]), nullptr);
    parent_ = pattern;
    directory_ = parent_ + "/a/b";
  }
  void TearDown() override { std::filesystem::remove_all(parent_); }

  std::string parent_, directory_;
  LioConfig config_{};
};

LioResult result(int i) {
  LioResult r;
  NavState& nav = r.state.nav;
  nav.stamp = 1'600'000'000'000'000'001 + i * TimeNs{100'000'000};
  nav.T_world_imu = {exp_so3({0.1 * i, 0.2, 0.3}), {i / 3.0, -2, 3}};
  nav.velocity_world << 4, 5, 6;
  nav.gyro_bias << 0.1, 0.2, 0.3;
  nav.accel_bias << 0.4, 0.5, 0.6;
  for (int k = 0; k < kLioDof; ++k) r.covariance(k, k) = (k + 1.0) * (k + 1.0);
  r.covariance(kPosition, kPosition + 2) = r.covariance(kPosition + 2, kPosition) = 0.7;
  r.points = 1000;
  r.registered = 500;
  r.inliers = 400;
  r.iterations = 3;
  r.residual_rms = 0.01;
  r.outcome = i == 0 ? ScanOutcome::kFirst : ScanOutcome::kUpdated;
  r.localizability.support << 0.0, 0.1, 0.2, 0.3, 0.4, 0.5;
  r.localizability.probability << 0.5, 0.6, 0.7, 0.8, 0.9, 1.0;
  return r;
}

std::vector<std::string> lines_of(const std::string& path) {
  std::ifstream in(path);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> cells(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> result;
  for (std::string cell; std::getline(in, cell, ',');) result.push_back(cell);
  return result;
}

TEST_F(RunWriterTest, TheTrajectoryReadsBackToTheSameBits) {
  RunWriter writer(directory_, config_);
  for (int i = 0; i < 25; ++i) writer.add(result(i), 0.004);
  writer.finish(RunSummary{});
  const Trajectory trajectory = read_tum(directory_ + "/trajectory.tum");
  ASSERT_EQ(trajectory.size(), 25u);
  for (int i = 0; i < 25; ++i) {
    const NavState expected = result(i).state.nav;
    EXPECT_EQ(trajectory[i].stamp, expected.stamp);
    EXPECT_EQ(trajectory[i].pose.translation, expected.T_world_imu.translation);
    EXPECT_EQ(trajectory[i].pose.rotation.coeffs(), expected.T_world_imu.rotation.coeffs());
  }
}

TEST_F(RunWriterTest, StatesHaveAColumnForEveryName) {
  RunWriter writer(directory_, config_);
  writer.add(result(0), 0.004);
  writer.finish(RunSummary{});
  const std::vector<std::string> lines = lines_of(directory_ + "/states.csv");
  ASSERT_EQ(lines.size(), 2u);
  const std::vector<std::string> names = cells(lines[0]), values = cells(lines[1]);
  ASSERT_EQ(names.size(), values.size());
  const auto value = [&](const std::string& name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? "no column " + name : values[found - names.begin()];
  };
  EXPECT_EQ(value("t"), "1600000000.000000001");
  EXPECT_EQ(std::stod(value("q_w")), result(0).state.nav.T_world_imu.rotation.w());
  EXPECT_EQ(std::stod(value("v_y")), 5.0);
  EXPECT_EQ(std::stod(value("ba_z")), 0.6);
  EXPECT_EQ(std::stod(value("g_z")), -9.80665);
  EXPECT_EQ(std::stod(value("sigma_theta_x")), 1.0);
  EXPECT_EQ(std::stod(value("sigma_p_x")), 4.0);
  EXPECT_EQ(std::stod(value("sigma_v_z")), 9.0);
  EXPECT_EQ(std::stod(value("sigma_bg_x")), 10.0);
  EXPECT_EQ(std::stod(value("sigma_ba_z")), 15.0);
  EXPECT_EQ(value("inliers"), "400");
  EXPECT_EQ(value("outcome"), "first");
  EXPECT_EQ(std::stod(value("support_5")), 0.5);
  EXPECT_EQ(std::stod(value("probability_0")), 0.5);
  EXPECT_EQ(std::stod(value("cov_p_xy")), 0.0);
  EXPECT_EQ(std::stod(value("cov_p_xz")), 0.7);
  EXPECT_EQ(std::stod(value("cov_ba_yz")), 0.0);
  // Level, at rest attitude known to 1, 2 and 3 rad, gravity to 16 and 17: the variances add.
  EXPECT_NEAR(std::stod(value("cov_tilt_00")) + std::stod(value("cov_tilt_11")), 1 + 4 + 256 + 289, 5.0);
  EXPECT_GT(std::stod(value("cov_v_imu_zz")), 49.0);
}

TEST_F(RunWriterTest, TheSummaryIsYamlThatHoldsTheWholeStory) {
  RunWriter writer(directory_, config_);
  for (int i = 0; i < 100; ++i) writer.add(result(i), 0.001 * (i + 1));
  RunSummary summary;
  summary.counters.scans_read = 110;
  summary.counters.scans_used = 100;
  summary.counters.scans_before_imu = 3;
  summary.counters.scans_too_few_points = 7;
  summary.counters.imu_read = 2000;
  summary.counters.points_over_budget = 12345;
  summary.map_megabytes = 12.5;
  summary.map_voxels = 4321;
  summary.notes = {"point time: \"t\" [ns], from the start", "a: b # c\nsecond line\t\\"};
  summary.inputs = {"/data/a b.bag"};
  writer.finish(summary);

  const YAML::Node yaml = YAML::LoadFile(directory_ + "/summary.yaml");
  EXPECT_EQ(yaml["status"].as<std::string>(), "complete");
  EXPECT_EQ(yaml["inputs"][0].as<std::string>(), summary.inputs[0]);
  EXPECT_EQ(yaml["notes"].as<std::vector<std::string>>(), summary.notes);
  EXPECT_EQ(yaml["scans"]["read"].as<int>(), 110);
  EXPECT_EQ(yaml["scans"]["used"].as<int>(), 100);
  EXPECT_EQ(yaml["scans"]["skipped"].as<int>(), 10);
  EXPECT_EQ(yaml["scans"]["skipped_because"]["too_few_points"].as<int>(), 7);
  EXPECT_EQ(yaml["imu"]["samples"].as<int>(), 2000);
  EXPECT_EQ(yaml["points"]["over_budget"].as<int>(), 12345);
  EXPECT_NEAR(yaml["time_per_scan_ms"]["mean"].as<double>(), 50.5, 1e-3);
  EXPECT_NEAR(yaml["time_per_scan_ms"]["p50"].as<double>(), 50.0, 1e-3);
  EXPECT_NEAR(yaml["time_per_scan_ms"]["p95"].as<double>(), 95.0, 1e-3);
  EXPECT_NEAR(yaml["time_per_scan_ms"]["max"].as<double>(), 100.0, 1e-3);
  EXPECT_GT(yaml["peak_rss_mb"].as<double>(), 1.0);
  EXPECT_EQ(yaml["map"]["megabytes"].as<double>(), 12.5);
  EXPECT_EQ(yaml["map"]["voxels"].as<int>(), 4321);
  EXPECT_EQ(yaml["parameters_hash"].as<std::string>(), config_hash(config_));
  EXPECT_TRUE(yaml["parameters"].IsMap());
}

TEST_F(RunWriterTest, ARunThatIsNotFinishedIsMarkedInterruptedAndKeepsItsRows) {
  {
    RunWriter writer(directory_, config_);
    for (int i = 0; i < 5; ++i) writer.add(result(i), 0.004);
  }
  EXPECT_EQ(read_tum(directory_ + "/trajectory.tum").size(), 5u);
  const YAML::Node yaml = YAML::LoadFile(directory_ + "/summary.yaml");
  EXPECT_EQ(yaml["status"].as<std::string>(), "interrupted");
  EXPECT_EQ(yaml["scans"]["used"].as<int>(), 5);
}

TEST_F(RunWriterTest, RowsReachTheDiskWhileTheRunGoesOn) {
  RunWriter writer(directory_, config_);
  for (int i = 0; i < 40; ++i) {
    writer.add(result(i), 0.004);
    // Ten scans a second of data: never more than one second is missing.
    EXPECT_GE(lines_of(directory_ + "/trajectory.tum").size() + 10, static_cast<std::size_t>(i + 1));
    EXPECT_GE(lines_of(directory_ + "/states.csv").size() + 10, static_cast<std::size_t>(i + 2));
  }
}

TEST_F(RunWriterTest, AnEmptyRunHasAValidSummary) {
  RunWriter writer(directory_, config_);
  RunSummary summary;
  summary.status = "incomplete: no scan";
  writer.finish(summary);
  const YAML::Node yaml = YAML::LoadFile(directory_ + "/summary.yaml");
  EXPECT_EQ(yaml["status"].as<std::string>(), "incomplete: no scan");
  EXPECT_EQ(yaml["time_per_scan_ms"]["max"].as<double>(), 0.0);
  EXPECT_TRUE(yaml["notes"].IsSequence());
}

TEST_F(RunWriterTest, ADirectoryThatCannotBeMadeIsNamed) {
  std::filesystem::create_directories(parent_);
  std::ofstream(parent_ + "/a") << "a file where a directory should be";
  try {
    RunWriter writer(directory_, config_);
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(directory_), std::string::npos) << error.what();
  }
}

TEST_F(RunWriterTest, AFullDiskIsAnErrorThatNamesTheFileAndIsInTheSummary) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  std::filesystem::create_directories(directory_);
  std::filesystem::create_symlink("/dev/full", directory_ + "/trajectory.tum");
  RunWriter writer(directory_, config_);
  for (int i = 0; i < 25; ++i) writer.add(result(i), 0.004);
  try {
    writer.finish(RunSummary{});
    FAIL() << "a lost trajectory was not noticed";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("trajectory.tum"), std::string::npos) << error.what();
  }
  const YAML::Node yaml = YAML::LoadFile(directory_ + "/summary.yaml");
  EXPECT_NE(yaml["status"].as<std::string>().find("incomplete"), std::string::npos);
  EXPECT_EQ(lines_of(directory_ + "/states.csv").size(), 26u) << "what could be kept is kept";
}

TEST_F(RunWriterTest, AFullDiskIsKnownWhileTheRunGoesOn) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  std::filesystem::create_directories(directory_);
  std::filesystem::create_symlink("/dev/full", directory_ + "/trajectory.tum");
  {
    RunWriter writer(directory_, config_);
    EXPECT_EQ(writer.trouble(), "");
    writer.add(result(0), 0.004);
    const std::string said = writer.trouble();
    EXPECT_EQ(said.find(directory_ + "/trajectory.tum: could not be written"), 0u) << said;
    for (int i = 1; i < 25; ++i) writer.add(result(i), 0.004);
    EXPECT_EQ(writer.trouble(), said);
  }
  EXPECT_EQ(lines_of(directory_ + "/states.csv").size(), 26u) << "the other file goes on";
  const std::string status = YAML::LoadFile(directory_ + "/summary.yaml")["status"].as<std::string>();
  EXPECT_EQ(status.find("incomplete: " + directory_ + "/trajectory.tum"), 0u) << status;
}

TEST_F(RunWriterTest, TheParametersAreThoseInForceAtTheEndAndThoseAtTheStartWhereTheyDiffer) {
  LioConfig changed = config_;
  changed.imu.scale.k_gb = 25.0;
  for (const LioConfig& last : {changed, config_}) {
    RunWriter writer(directory_, config_);
    writer.reconfigure(changed);
    writer.reconfigure(last);
    writer.finish(RunSummary{});
    const YAML::Node yaml = YAML::LoadFile(directory_ + "/summary.yaml");
    EXPECT_EQ(yaml["parameters_hash"].as<std::string>(), config_hash(last));
    EXPECT_EQ(yaml["parameters"]["imu"]["k_gb"].as<double>(), last.imu.scale.k_gb);
    const bool differ = last.imu.scale.k_gb != config_.imu.scale.k_gb;
    EXPECT_EQ(yaml["parameters_at_start"].IsDefined(), differ);
    EXPECT_EQ(yaml["parameters_hash_at_start"].IsDefined(), differ);
    if (!differ) continue;
    EXPECT_EQ(yaml["parameters_hash_at_start"].as<std::string>(), config_hash(config_));
    EXPECT_EQ(yaml["parameters_at_start"]["imu"]["k_gb"].as<double>(), config_.imu.scale.k_gb);
  }
}

}  // namespace
}  // namespace allan_lio
