// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/config_source.h"
#include "allan_lio/io/yaml_source.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

// Measured over six seeds: at most 5.0 mm and 0.09 deg with planes, 4.6 mm and 0.10 deg with points.
constexpr double kAteBound = 0.015;                    // [m]
constexpr double kRotationBound = 0.3 * M_PI / 180.0;  // [rad]

constexpr char kDocumentedColumns[] =
    "t,p_x,p_y,p_z,q_x,q_y,q_z,q_w,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z,g_x,g_y,g_z,"
    "sigma_theta_x,sigma_theta_y,sigma_theta_z,sigma_p_x,sigma_p_y,sigma_p_z,sigma_v_x,sigma_v_y,sigma_v_z,"
    "sigma_bg_x,sigma_bg_y,sigma_bg_z,sigma_ba_x,sigma_ba_y,sigma_ba_z,";

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

/// states.csv: the columns by name, as text.
struct States {
  std::string header;
  std::vector<std::map<std::string, std::string>> rows;

  explicit States(const std::string& path) {
    std::istringstream in(contents_of(path));
    std::getline(in, header);
    const std::vector<std::string> names = split(header);
    for (std::string line; std::getline(in, line);) {
      const std::vector<std::string> fields = split(line);
      EXPECT_EQ(fields.size(), names.size()) << line;
      rows.emplace_back();
      for (std::size_t i = 0; i < std::min(fields.size(), names.size()); ++i) rows.back()[names[i]] = fields[i];
    }
  }
};

TrajectoryError error_of(const std::string& out) {
  return evaluate_trajectory(read_tum(SimulatedBag::get().truth()), read_tum(out + "/trajectory.tum"), Alignment::kSe3);
}

TEST(LioOffline, EveryScanOfARichSceneGetsAStateCloseToTheTruth) {
  const TemporaryDirectory out;
  const Outcome run = run_lio_offline(SimulatedBag::get().bag(), out.path());
  ASSERT_EQ(run.status, 0) << run.text;
  EXPECT_NE(run.text.find("200 of 200 scans used"), std::string::npos) << run.text;
  const TrajectoryError error = error_of(out.path());
  EXPECT_EQ(error.matched, static_cast<std::size_t>(SimulatedBag::kScans));
  EXPECT_LT(error.translation.rmse, kAteBound);
  EXPECT_LT(error.rotation.rmse, kRotationBound);
}

TEST(LioOffline, TheMapOfPointsDoesSoToo) {
  const TemporaryDirectory out;
  const Outcome run = run_lio_offline(SimulatedBag::get().bag(), out.path(), "--param map/structure=points");
  ASSERT_EQ(run.status, 0) << run.text;
  const TrajectoryError error = error_of(out.path());
  EXPECT_EQ(error.matched, static_cast<std::size_t>(SimulatedBag::kScans));
  EXPECT_LT(error.translation.rmse, kAteBound);
  EXPECT_LT(error.rotation.rmse, kRotationBound);
}

TEST(LioOffline, StatesAreFiniteAndTheirSigmasPositive) {
  const TemporaryDirectory out;
  ASSERT_EQ(run_lio_offline(SimulatedBag::get().bag(), out.path()).status, 0);
  const States states(out.file("states.csv"));
  EXPECT_EQ(states.header.rfind(kDocumentedColumns, 0), 0U) << states.header;
  const Trajectory trajectory = read_tum(out.file("trajectory.tum"));
  ASSERT_EQ(states.rows.size(), trajectory.size());
  for (std::size_t i = 0; i < states.rows.size(); ++i) {
    EXPECT_EQ(states.rows[i].at("t"), format_seconds(trajectory[i].stamp));
    EXPECT_EQ(std::stod(states.rows[i].at("p_x")), trajectory[i].pose.translation.x());
    for (const auto& [name, text] : states.rows[i]) {
      if (name == "outcome") continue;
      const double value = std::stod(text);
      EXPECT_TRUE(std::isfinite(value)) << name << " in row " << i;
      // The world is the first pose's, so that one has no uncertainty.
      const bool pose = name.rfind("sigma_theta", 0) == 0 || name.rfind("sigma_p", 0) == 0;
      const bool positive = name.rfind("sigma_", 0) == 0 && !(pose && i == 0);
      EXPECT_TRUE(!positive || value > 0.0) << name << " in row " << i;
    }
  }
  EXPECT_EQ(states.rows.front().at("outcome"), "first");
  EXPECT_EQ(states.rows.back().at("outcome"), "updated");
}

TEST(LioOffline, TheSummaryCountsWhatWasReadAndHoldsTheParametersInForce) {
  const TemporaryDirectory out;
  ASSERT_EQ(run_lio_offline(SimulatedBag::get().bag(), out.path(), "--param imu/k_gb=3").status, 0);
  const YAML::Node summary = YAML::LoadFile(out.file("summary.yaml"));
  EXPECT_EQ(summary["status"].as<std::string>(), "complete");
  EXPECT_EQ(summary["inputs"][0].as<std::string>(), SimulatedBag::get().bag());
  EXPECT_EQ(summary["scans"]["read"].as<int>(), SimulatedBag::kScans);
  EXPECT_EQ(summary["scans"]["used"].as<int>(), SimulatedBag::kScans);
  EXPECT_EQ(summary["scans"]["used"].as<std::size_t>(), read_tum(out.file("trajectory.tum")).size());
  EXPECT_EQ(summary["scans"]["skipped"].as<int>(), 0);
  for (const auto& reason : summary["scans"]["skipped_because"]) EXPECT_EQ(reason.second.as<int>(), 0);
  EXPECT_EQ(summary["imu"]["samples"].as<int>(), SimulatedBag::kImuSamples);
  const YAML::Node time = summary["time_per_scan_ms"];
  EXPECT_GT(time["mean"].as<double>(), 0.0);
  EXPECT_GT(time["p50"].as<double>(), 0.0);
  EXPECT_LE(time["p50"].as<double>(), time["p95"].as<double>());
  EXPECT_LE(time["p95"].as<double>(), time["max"].as<double>());
  EXPECT_LE(time["mean"].as<double>(), time["max"].as<double>());
  EXPECT_GT(summary["peak_rss_mb"].as<double>(), 1.0);
  EXPECT_GT(summary["map"]["voxels"].as<int>(), 100);
  EXPECT_GT(summary["map"]["megabytes"].as<double>(), 0.0);

  YAML::Emitter parameters;
  parameters << summary["parameters"];
  const LioConfig config = read_config(parse_yaml(parameters.c_str(), "summary.yaml"));
  EXPECT_EQ(config.imu.scale.k_gb, 3.0);
  EXPECT_EQ(config_hash(config), summary["parameters_hash"].as<std::string>());
}

TEST(LioOffline, TwoRunsAndOneOrTwoThreadsGiveTheSameBytes) {
  const TemporaryDirectory out;
  const std::string bag = SimulatedBag::get().bag();
  ASSERT_EQ(run_lio_offline(bag, out.file("first")).status, 0);
  ASSERT_EQ(run_lio_offline(bag, out.file("one"), "--threads 1").status, 0);
  ASSERT_EQ(run_lio_offline(bag, out.file("two"), "--threads 2").status, 0);
  for (const char* file : {"trajectory.tum", "states.csv"}) {
    const std::string expected = contents_of(out.file("first/") + file);
    EXPECT_GT(expected.size(), 10000U);
    EXPECT_TRUE(expected == contents_of(out.file("one/") + file)) << file << ": two runs differ";
    EXPECT_TRUE(expected == contents_of(out.file("two/") + file)) << file << ": two threads differ from one";
  }
}

TEST(LioOffline, TheMapIsWrittenOnRequest) {
  const TemporaryDirectory out;
  ASSERT_EQ(run_lio_offline(SimulatedBag::get().bag(), out.path(), "--map").status, 0);
  const std::string pcd = contents_of(out.file("map.pcd"));
  const std::size_t at = pcd.find("\nPOINTS ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_GT(std::atoi(pcd.c_str() + at + 8), 1000);
}

TEST(LioOffline, HelpNamesEveryOption) {
  const Outcome help = run_tool("lio_offline --help");
  EXPECT_EQ(help.status, 0);
  for (const char* option : {"--bag", "--config", "--param", "--threads", "--out", "--map"})
    EXPECT_NE(help.text.find(option), std::string::npos) << option;
}

}  // namespace
}  // namespace allan_lio
