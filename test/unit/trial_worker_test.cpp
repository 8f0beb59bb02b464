// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_worker.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "allan_lio/io/trial_files.h"
#include "allan_lio/io/whole_file.h"
#include "allan_lio/lidar/thin_scan.h"
#include "child_process.h"
#include "simulated_drive.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

/// 4 s of a drive with its truth.
PreparedRecord short_record(const std::string& scene) {
  const SimulatedDrive drive = simulate_drive(scene, 4.0, 1);
  const LioConfig config = simulated_robot();
  PreparedRecord record;
  ScanDownsampler downsampler;
  for (const ImuSample& sample : drive.imu) record.add(sample);
  for (const Scan& scan : drive.scans)
    record.add(thin_scan(scan, config.map.insert_leaf, config.lidar.leaf, downsampler));
  record.set_reference(drive.truth);
  return record;
}

TrialProblem two_bags() {
  std::vector<TuningBag> bags;
  bags.push_back({"rooms \"one\"", simulated_robot(), short_record("rooms")});
  bags.push_back({"city", simulated_robot(), short_record("city")});
  bags[1].config.lidar.range_noise *= 2.0;
  return TrialProblem(std::move(bags), 18446744073709551615U);
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(PreparedRecordFile, ComesBackToTheSameBits) {
  const TemporaryDirectory directory;
  const PreparedRecord record = short_record("rooms");
  record.save(directory.file("a.bin"));
  const PreparedRecord back = PreparedRecord::load(directory.file("a.bin"));
  EXPECT_EQ(back.digest(), record.digest());
  EXPECT_EQ(back.scans(), record.scans());
  EXPECT_EQ(back.reference().size(), record.reference().size());
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(directory.path()), {}), 1) << "nothing else is left";
}

TEST(PreparedRecordFile, WhatIsCutOffDamagedOrSomethingElseIsRefusedByName) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a.bin");
  short_record("rooms").save(path);
  const std::string whole = contents_of(path);
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{20}, std::size_t{0}}) {
    write_whole(path, whole.substr(0, length));
    EXPECT_EQ(refusal([&] { PreparedRecord::load(path); }).rfind(path + ": is ", 0), 0U) << length;
  }
  for (const std::size_t place : {std::size_t{3}, std::size_t{17}, std::size_t{23}, whole.size() / 2}) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x40);
    write_whole(path, damaged);
    EXPECT_NE(refusal([&] { PreparedRecord::load(path); }).find(path), std::string::npos) << place;
  }
  write_whole(path, whole + "x");
  EXPECT_NE(refusal([&] { PreparedRecord::load(path); }).find("after its end"), std::string::npos);
  EXPECT_NE(refusal([&] { PreparedRecord::load(directory.file("none")); }).find("none"), std::string::npos);
}

TEST(TrialWorker, GivesTheBitsOfTheProcessThatWroteTheProblem) {
  const TemporaryDirectory directory;
  const TrialProblem problem = two_bags();
  const std::string file = write_worker_problem(directory.file("shared"), problem);
  std::vector<NoiseTrial> trials = {{1, {}, 0}, {0, {}, 2}};
  trials[1].setting.imu.k_gb = 1.0 / 3.0;
  write_trials(directory.file("trials"), trials);
  run_worker(file, directory.file("trials"), directory.file("results"));
  const std::vector<TrialResult> results = read_results(directory.file("results"));
  ASSERT_EQ(results.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const TrialResult expected = problem.run(trials[i]);
    EXPECT_EQ(results[i].nll, expected.nll);
    EXPECT_EQ(results[i].ate, expected.ate);
    EXPECT_FALSE(results[i].diverged);
  }
}

TEST(TrialWorker, AnotherBuildsProblemAndAMissingRecordAreRefused) {
  const TemporaryDirectory directory;
  const std::string file = write_worker_problem(directory.path(), two_bags());
  write_trials(directory.file("trials"), {{1, {}, 0}});
  const auto work = [&] { run_worker(file, directory.file("trials"), directory.file("results")); };
  for (const auto& entry : std::filesystem::directory_iterator(directory.path()))
    if (entry.path().extension() == ".bin") std::filesystem::remove(entry.path());
  EXPECT_NE(refusal(work).find("record_"), std::string::npos);
  std::string text = contents_of(file);
  text.replace(text.find("build: \"") + 8, 4, "0000");
  write_whole(file, text);
  EXPECT_NE(refusal(work).find("another build"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
