// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "allan_lio/io/tum.h"
#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

Outcome evaluate(const std::string& arguments) { return run_tool("evaluate_trajectory " + arguments); }

class EvaluateTrajectoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Trajectory reference, estimate;
    for (int i = 0; i < 101; ++i) {  // an L of 50 m and 50 m, the estimate 2 m above it
      StampedPose pose;
      pose.stamp = 1'600'000'000 * kNsPerSecond + i * (kNsPerSecond / 10);
      pose.pose.translation << std::min(i, 50), std::max(i - 50, 0), 0;
      reference.push_back(pose);
      pose.pose.translation.z() += 2.0;
      estimate.push_back(pose);
    }
    write_tum(file("reference.tum"), reference);
    write_tum(file("estimate.tum"), estimate);
  }

  std::string file(const std::string& name) const { return directory_.file(name); }
  std::string both() const { return "--reference " + file("reference.tum") + " --estimate " + file("estimate.tum"); }

  TemporaryDirectory directory_;
};

TEST_F(EvaluateTrajectoryTest, JsonHoldsEveryFigureUnderItsKey) {
  constexpr double kRounding = 1e-9;
  const Outcome outcome = evaluate(both() + " --align none --json");
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  const YAML::Node json = YAML::Load(outcome.text);  // JSON is YAML
  EXPECT_EQ(json["align"].as<std::string>(), "none");
  EXPECT_EQ(json["matched"].as<int>(), 101);
  EXPECT_EQ(json["unmatched"].as<int>(), 0);
  EXPECT_NEAR(json["duration"].as<double>(), 10.0, kRounding);
  EXPECT_NEAR(json["path_length"].as<double>(), 100.0, kRounding);
  for (const char* key : {"rmse", "mean", "median", "max"})
    EXPECT_NEAR(json["ate"][key].as<double>(), 2.0, kRounding) << key;
  EXPECT_NEAR(json["ate"]["rotation_rmse_deg"].as<double>(), 0.0, kRounding);
  for (const char* relative : {"rpe_1s", "rpe_10m"}) {
    EXPECT_GT(json[relative]["pairs"].as<int>(), 0) << relative;
    for (const char* key : {"translation_rmse", "translation_percent", "rotation_rmse_deg"})
      EXPECT_NEAR(json[relative][key].as<double>(), 0.0, kRounding) << relative << " " << key;
  }
  EXPECT_NEAR(json["end_drift_m"].as<double>(), 0.0, kRounding);
  EXPECT_NEAR(json["end_drift_percent"].as<double>(), 0.0, kRounding);
}

TEST_F(EvaluateTrajectoryTest, Se3IsTheDefaultAndTheTableSaysSo) {
  const Outcome outcome = evaluate(both());
  EXPECT_EQ(outcome.status, 0);
  EXPECT_NE(outcome.text.find("alignment            se3"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("rmse 0.0000"), std::string::npos) << outcome.text;
}

TEST_F(EvaluateTrajectoryTest, ErrorsAreWrittenOneLineAPose) {
  const Outcome outcome = evaluate(both() + " --align none --errors " + file("errors.csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  std::ifstream in(file("errors.csv"));
  std::string line;
  std::getline(in, line);
  EXPECT_EQ(line, "t,e_x,e_y,e_z,translation_m,rotation_deg");
  std::getline(in, line);
  EXPECT_EQ(line, "1600000000.000000000,0,0,2,2,0");
  int lines = 2;
  while (std::getline(in, line)) ++lines;
  EXPECT_EQ(lines, 102);
}

TEST_F(EvaluateTrajectoryTest, BadInputEndsWithASentenceAndAStatus) {
  std::ofstream(file("bad.tum")) << "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n";
  const std::string reference = "--reference " + file("reference.tum");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {reference + " --estimate " + file("bad.tum"), "bad.tum:2: the stamp 1 is not later"},
      {reference + " --estimate " + file("absent.tum"), "absent.tum: cannot be opened"},
      {reference, "--estimate is required"},
      {both() + " --align sim3", "sim3 not in"},
      {both() + " --errors " + file("no/such/directory.csv"), "directory.csv: cannot be written"}};
  for (const auto& [arguments, sentence] : cases) {
    const Outcome outcome = evaluate(arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << arguments << " gives " << outcome.text;
  }
}

/// states.csv of the run's tail beyond the pose: everything known to 0.1, all correlations zero. From the pose
/// `blind_from` on nothing supports it and the position's sigma grows along x.
void write_states(const std::string& path, const Trajectory& estimate, std::size_t blind_from = SIZE_MAX) {
  std::ofstream out(path);
  out << "t,p_x,p_y,p_z,q_x,q_y,q_z,q_w,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z,g_x,g_y,g_z,"
         "sigma_theta_x,sigma_theta_y,sigma_theta_z,sigma_p_x,sigma_p_y,sigma_p_z,sigma_bg_x,sigma_bg_y,sigma_bg_z,"
         "sigma_ba_x,sigma_ba_y,sigma_ba_z,support_0,cov_p_xy,cov_p_xz,cov_p_yz,cov_theta_xy,cov_theta_xz,cov_theta_yz,"
         "cov_bg_xy,cov_bg_xz,cov_bg_yz,cov_ba_xy,cov_ba_xz,cov_ba_yz,cov_tilt_00,cov_tilt_01,cov_tilt_11,"
         "cov_v_imu_xx,cov_v_imu_xy,cov_v_imu_xz,cov_v_imu_yy,cov_v_imu_yz,cov_v_imu_zz\n";
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Vector3d& p = estimate[i].pose.translation;
    const bool blind = i >= blind_from;
    out << format_seconds(estimate[i].stamp) << ',' << p.x() << ',' << p.y() << ',' << p.z()
        << ",0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,-9.8,.1,.1,.1," << (blind ? 0.01 * static_cast<double>(i) : 0.1)
        << ",.1,.1,.1,.1,.1,.1,.1,.1," << (blind ? 0.1 : 1.0)
        << ",0,0,0,0,0,0,0,0,0,0,0,0,0.01,0,0.01,100,0,0,100,0,100\n";
  }
}

TEST_F(EvaluateTrajectoryTest, ConsistencyStandsBesideTheErrorsAndChangesNoneOfThem) {
  constexpr double kRounding = 1e-6;
  write_states(file("states.csv"), read_tum(file("estimate.tum")));
  const std::string states = " --align none --states " + file("states.csv") + " --axis 1,0,0";
  const Outcome plain = evaluate(both() + " --align none"), more = evaluate(both() + states);
  ASSERT_EQ(more.status, 0) << more.text;
  EXPECT_EQ(more.text.rfind(plain.text, 0), 0U) << more.text;
  EXPECT_NE(more.text.find("holds the error in 100.0 % of the scans"), std::string::npos) << more.text;

  const Outcome outcome = evaluate(both() + states + " --json --series " + file("series.csv"));
  const YAML::Node json = YAML::Load(outcome.text)["consistency"];
  EXPECT_EQ(json["times"].as<int>(), 101);
  EXPECT_NEAR(json["three_sigma_share"].as<double>(), 1.0, kRounding);
  EXPECT_NEAR(json["nees_per_dof"]["along"]["mean"].as<double>(), 0.0, kRounding) << "the constant 2 m is no error";
  EXPECT_NEAR(json["nees_per_dof"]["velocity"]["mean"].as<double>(), 100.0 / 100.0 / 3.0, 0.01) << "10 m/s of 10";
  EXPECT_TRUE(json["nees_per_dof"]["gyro_bias"].IsNull());
  EXPECT_TRUE(json["nees_per_dof"]["innovation"].IsNull());

  const std::string run = " --over-runs " + file("series.csv");
  const Outcome over = evaluate(run + run + " --json");
  ASSERT_EQ(over.status, 0) << over.text;
  EXPECT_EQ(YAML::Load(over.text)["runs"].as<int>(), 2);
  EXPECT_NEAR(YAML::Load(over.text)["nees_per_dof"]["velocity"]["mean"].as<double>(),
              json["nees_per_dof"]["velocity"]["mean"].as<double>(), 1e-4);
  const Outcome plotted = run_command("/usr/bin/python3 " ALLAN_LIO_SOURCE_DIR "/scripts/plot_consistency --series " +
                                      file("series.csv") + " --out " + file("plots"));
  EXPECT_EQ(plotted.status, 0) << plotted.text;
  for (const char* name : {"plots/consistency_errors.png", "plots/consistency_nees.png"})
    EXPECT_EQ(contents_of(file(name)).substr(1, 3), "PNG");
}

TEST_F(EvaluateTrajectoryTest, BesideAStretchWithoutSupportStandsWhatCouldBeKnown) {
  write_states(file("states.csv"), read_tum(file("estimate.tum")), 21);
  const std::string states = both() + " --align none --states " + file("states.csv") + " --json --bound mti600 --axis ";
  for (const char* axis : {"motion", "1,0,0", "weakest"}) {
    const Outcome outcome = evaluate(states + axis);
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    const YAML::Node blind = YAML::Load(outcome.text)["consistency"]["blind"];
    ASSERT_EQ(blind.size(), 1U) << outcome.text;
    EXPECT_GT(blind[0]["bound"].as<double>(), 0.001) << axis;
    EXPECT_EQ(blind[0]["known_tilt"].IsNull(), std::string(axis) == "weakest");
  }
}

TEST_F(EvaluateTrajectoryTest, StatesThatLackAColumnAreToldByName) {
  std::ofstream(file("old.csv")) << "t,p_x\n1600000000.0,1\n";
  const Outcome outcome = evaluate(both() + " --states " + file("old.csv"));
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.text.find("old.csv: has no column p_y"), std::string::npos) << outcome.text;
}

TEST_F(EvaluateTrajectoryTest, HelpNamesEveryOption) {
  const Outcome outcome = evaluate("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* option : {"--reference", "--estimate", "--align", "--json", "--errors", "--max-gap", "--states",
                             "--truth-biases", "--axis", "--series", "--bound", "--over-runs"})
    EXPECT_NE(outcome.text.find(option), std::string::npos) << option;
}

}  // namespace
}  // namespace allan_lio
