// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
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

TEST_F(EvaluateTrajectoryTest, HelpNamesEveryOption) {
  const Outcome outcome = evaluate("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* option : {"--reference", "--estimate", "--align", "--json", "--errors", "--max-gap"})
    EXPECT_NE(outcome.text.find(option), std::string::npos) << option;
}

}  // namespace
}  // namespace allan_lio
