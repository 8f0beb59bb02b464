// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

Outcome bench(const std::string& arguments) {
  return run_command("/usr/bin/python3 " ALLAN_LIO_SOURCE_DIR "/scripts/bench --bin " ALLAN_LIO_BIN_DIR " " +
                     arguments);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
  return n;
}

class BenchSuiteTest : public ::testing::Test {
 protected:
  std::string write(const std::string& text) {
    std::ofstream(directory_.file("suite.yaml")) << text;
    return "--suite " + directory_.file("suite.yaml") + " --out " + directory_.file("out") + " ";
  }

  TemporaryDirectory directory_;
};

TEST_F(BenchSuiteTest, ATinySuiteGivesItsTablesAndIsNotRunTwice) {
  const std::string suite = write(
      "defaults: {imu: mti600}\n"
      "sequences:\n"
      "  tiny: {scene: rooms, duration: 4, axis: weakest, bound: true, simulate: {range-noise: 0.02}}\n");
  const std::string arguments = suite + "--seeds 1-2 --bound --setting 'one=' --setting 'ten=imu/k_gb=10;imu/k_ab=10'";
  const Outcome first = bench(arguments);
  ASSERT_EQ(first.status, 0) << first.text;
  EXPECT_NE(first.text.find("| RMSE (ATE, se3) [m] | | one | ten |"), std::string::npos) << first.text;
  EXPECT_NE(first.text.find("| tiny | maximum | 0.0"), std::string::npos) << first.text;
  EXPECT_NE(first.text.find("| posterior bound [m] | IMU alone, tilt known [m] |"), std::string::npos) << first.text;
  EXPECT_NE(first.text.find("[4/4] tiny 2"), std::string::npos) << first.text;

  const std::string out = directory_.file("out");
  const std::string results = contents_of(out + "/results.csv"), table = contents_of(out + "/table.csv");
  EXPECT_EQ(count(results, "\n"), 5U) << results;
  EXPECT_EQ(count(results, ",complete,"), 4U) << results;
  EXPECT_EQ(count(table, "\n"), 3U) << table;
  EXPECT_NE(table.find("nees_gyro_bias_mean"), std::string::npos) << "the truth's biases were not used";
  EXPECT_EQ(contents_of(out + "/table.png").substr(1, 3), "PNG");
  EXPECT_EQ(count(first.text, contents_of(out + "/table.md")), 1U);

  const Outcome second = bench(arguments);
  EXPECT_EQ(second.status, 0) << second.text;
  EXPECT_EQ(second.text, contents_of(out + "/table.md")) << "something was run again";
  EXPECT_EQ(contents_of(out + "/results.csv"), results);

  for (const auto& entry : std::filesystem::directory_iterator(ALLAN_LIO_SOURCE_DIR "/.demo/bench"))
    EXPECT_NE(entry.path().filename().string().rfind("tiny_", 0), 0U) << entry.path() << " is left over";
}

TEST_F(BenchSuiteTest, ASceneThatCannotBeMadeIsToldAndTheOthersRun) {
  const std::string suite =
      write("sequences:\n  absent: {scene: no_such_scene}\n  other: {scene: rooms, duration: 3, config: simulated}\n");
  const Outcome outcome = bench(suite + "--seeds 1");
  EXPECT_NE(outcome.status, 0);
  EXPECT_NE(outcome.text.find("absent: simulate_bag failed"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.text.find("| other | maximum | 0.0"), std::string::npos) << outcome.text;
}

TEST_F(BenchSuiteTest, MistakesNameFileAndKey) {
  const std::string good = "  a: {scene: rooms}\n";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"sequences:\n  a: {scnee: rooms}\n", "suite.yaml: sequences/a: unknown key 'scnee', did you mean 'scene'?"},
      {"sequences:\n" + good + "seqences: {}\n", "suite.yaml: unknown key 'seqences', did you mean 'sequences'?"},
      {"defaults: {imus: x}\nsequences:\n" + good, "suite.yaml: defaults: unknown key 'imus'"},
      {"sequences:\n  a: {imu: mti600}\n", "suite.yaml: sequences/a: needs a scene"},
      {"sequences:\n  a: {scene: rooms, duration: -1}\n", "sequences/a: duration: '-1' is not a positive number"},
      {"sequences:\n  a: {scene: rooms, seed_offset: x}\n", "sequences/a: seed_offset: 'x' is not a whole number"},
      {"sequences:\n  a: {scene: rooms, axis: up}\n", "sequences/a: axis: 'up' is not path, motion"},
      {"sequences:\n  a: {scene: rooms, axis: [0, 0, 0]}\n", "sequences/a: axis:"},
      {"sequences:\n  a: {scene: rooms, bound: 3}\n", "sequences/a: bound: '3' is not true or false"},
      {"sequences:\n  a: {scene: rooms, simulate: [1]}\n", "sequences/a: simulate: must be a mapping"},
      {"sequences:\n  'a b': {scene: rooms}\n", "sequences/a b: a name holds letters"},
      {"sequences: {}\n", "suite.yaml: sequences: must be a mapping of at least one"},
      {"[1, 2]\n", "suite.yaml: must be a mapping"},
      {"sequences: {a\n", "suite.yaml: "},
  };
  for (const auto& [text, sentence] : cases) {
    const Outcome outcome = bench(write(text) + "--seeds 1");
    EXPECT_NE(outcome.status, 0) << text;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << text << " gives " << outcome.text;
    EXPECT_EQ(outcome.text.find("Traceback"), std::string::npos) << outcome.text;
  }
  const std::vector<std::pair<std::string, std::string>> options = {
      {"--seeds 3-1", "3-1 is not a range"},
      {"--seeds x", "--seeds 'x': must be numbers and ranges"},
      {"--seeds 1 --setting k=x", "--setting 'k=x': must be NAME=KEY=VALUE"},
      {"--seeds 1 --setting a= --setting a=imu/k_g=2", "two settings have the name 'a'"},
      {"--seeds 1 --only b", "has no sequence 'b'"}};
  for (const auto& [arguments, sentence] : options) {
    const Outcome outcome = bench(write("sequences:\n" + good) + arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    EXPECT_NE(outcome.text.find(sentence), std::string::npos) << arguments << " gives " << outcome.text;
  }
}

TEST_F(BenchSuiteTest, EverySuiteThatShipsIsValid) {
  int suites = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ALLAN_LIO_SOURCE_DIR "/config/suites")) {
    // An unknown sequence is told only after the whole file was found in order.
    const Outcome outcome = bench("--suite " + entry.path().string() + " --seeds 1 --only no_such_sequence --out " +
                                  directory_.file("out"));
    EXPECT_NE(outcome.text.find("has no sequence 'no_such_sequence'"), std::string::npos) << outcome.text;
    ++suites;
  }
  EXPECT_GE(suites, 1);
}

}  // namespace
}  // namespace allan_lio
