// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
// Results that cannot be written, and runs that are interrupted.
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "simulated_bag.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

std::ptrdiff_t lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

class FaultyOutput : public ::testing::Test {
 protected:
  TemporaryDirectory directory_;
  std::string out_ = directory_.file("out");
};

TEST_F(FaultyOutput, AFullDiskIsNamedAndWhatCouldBeWrittenIsKept) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  for (const char* full : {"trajectory.tum", "states.csv"}) {
    const std::string other = full == std::string("states.csv") ? "trajectory.tum" : "states.csv";
    fs::remove_all(out_);
    fs::create_directories(out_);
    fs::create_symlink("/dev/full", out_ + "/" + full);
    const Outcome run = run_lio_offline(SimulatedBag::get().bag(), out_);
    EXPECT_EQ(run.status, 1) << full;
    EXPECT_NE(run.text.find(out_ + "/" + full + ": "), std::string::npos) << run.text;
    if (full == std::string("states.csv")) continue;  // known before the run: its header cannot be written
    EXPECT_GE(lines(contents_of(out_ + "/" + other)), SimulatedBag::kScans);
    const std::string status = YAML::LoadFile(out_ + "/summary.yaml")["status"].as<std::string>();
    EXPECT_NE(status.find("incomplete: " + out_ + "/" + full), std::string::npos) << status;
  }
}

TEST_F(FaultyOutput, WhatCanBeKnownBeforeTheRunIsSaidBeforeTheRun) {
  fs::create_directories(out_ + "/trajectory.tum");
  fs::create_directories(directory_.file("map/map.pcd"));
  std::ofstream(directory_.file("file")) << "no directory";
  const auto expect_at_once = [](const Outcome& run, const std::string& what) {
    EXPECT_EQ(run.status, 1) << run.text;
    EXPECT_NE(run.text.find(what), std::string::npos) << run.text;
    EXPECT_EQ(run.text.find("scans used"), std::string::npos) << run.text;
  };
  const std::string bag = SimulatedBag::get().bag();
  expect_at_once(run_lio_offline(bag, out_), out_ + "/trajectory.tum: cannot be written");
  expect_at_once(run_lio_offline(bag, directory_.file("map"), "--map"), "map.pcd: cannot be written");
  expect_at_once(run_lio_offline(bag, directory_.file("file")), directory_.file("file") + ": cannot be created");
}

/// Whatever the moment, what lies there is whole: every row, and a summary that says what became of the run.
void expect_whole(const std::string& out, const std::string& whole_run, const Outcome& run) {
  const YAML::Node summary = YAML::LoadFile(out + "/summary.yaml");
  const std::string status = summary["status"].as<std::string>();
  EXPECT_EQ(status, run.status == 0 ? "complete" : "interrupted");
  EXPECT_FALSE(summary["parameters"].IsNull());
  for (const char* file : {"/trajectory.tum", "/states.csv"}) {
    const std::string text = contents_of(out + file), expected = contents_of(whole_run + file);
    EXPECT_TRUE(text.empty() || text.back() == '\n') << file << " ends in the middle of a line";
    EXPECT_EQ(expected.compare(0, text.size(), text), 0) << file << " does not begin as that of the whole run";
  }
  EXPECT_EQ(lines(contents_of(out + "/trajectory.tum")), summary["scans"]["used"].as<std::ptrdiff_t>());
}

TEST_F(FaultyOutput, ASignalAtAnyMomentLeavesWholeFiles) {
  const std::string whole = directory_.file("whole");
  ASSERT_EQ(run_lio_offline(SimulatedBag::get().bag(), whole).status, 0);
  int interrupted = 0, moments = 0;
  for (const char* signal : {"INT", "TERM"}) {
    for (double after = 0.01; after < 1.0; after *= 1.8, ++moments) {
      fs::remove_all(out_);
      char command[1000];
      std::snprintf(command, sizeof command,
                    "ROS_PACKAGE_PATH=%s:$ROS_PACKAGE_PATH timeout --preserve-status -s %s %.3f %s/lio_offline "
                    "--bag %s --config simulated --out %s",
                    ALLAN_LIO_SOURCE_DIR, signal, after, ALLAN_LIO_BIN_DIR, SimulatedBag::get().bag().c_str(),
                    out_.c_str());
      const Outcome run = run_command(command);
      EXPECT_TRUE(run.status == 0 || run.status == 130 || run.status > 128) << run.status << ": " << run.text;
      // Where it came before the program had begun, there is nothing.
      if (fs::exists(out_)) expect_whole(out_, whole, run);
      interrupted += run.status == 130 && fs::exists(out_) ? 1 : 0;
    }
  }
  EXPECT_GT(interrupted, 0) << "of " << moments;
}

}  // namespace
}  // namespace allan_lio
