// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include "allan_lio/calib/trial_worker.h"

#include <gtest/gtest.h>

#include <cmath>
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

bool same_bits(const LinearScan& a, const LinearScan& b) {
  return a.time == b.time && a.step == b.step && a.phi == b.phi && a.noise == b.noise && a.bridged == b.bridged &&
         a.correction == b.correction && a.rows.rows() == b.rows.rows() && a.rows == b.rows &&
         a.map_rows == b.map_rows && a.measured == b.measured && a.variances == b.variances &&
         a.log_gram == b.log_gram && a.view_noise == b.view_noise && a.view_kept == b.view_kept &&
         a.deskewed == b.deskewed;
}

void expect_same_bits(const LinearisedTrial& a, const LinearisedTrial& b) {
  EXPECT_TRUE(a.trial.bag == b.trial.bag && a.trial.run == b.trial.run &&
              same_setting(a.trial.setting, b.trial.setting));
  EXPECT_EQ(a.result.ate, b.result.ate);
  EXPECT_EQ(a.result.end_error, b.result.end_error);
  EXPECT_EQ(a.result.nll, b.result.nll);
  EXPECT_EQ(a.result.nis, b.result.nis);
  EXPECT_EQ(a.result.nis_dof, b.result.nis_dof);
  EXPECT_EQ(a.result.horizon_nll, b.result.horizon_nll);
  EXPECT_EQ(a.result.horizon_nis, b.result.horizon_nis);
  EXPECT_EQ(a.result.horizon_dof, b.result.horizon_dof);
  EXPECT_EQ(a.result.horizon_share, b.result.horizon_share);
  EXPECT_EQ(a.result.scans, b.result.scans);
  EXPECT_EQ(a.result.diverged, b.result.diverged);
  EXPECT_EQ(a.run.initial_covariance, b.run.initial_covariance);
  EXPECT_EQ(a.run.gyro_psd, b.run.gyro_psd);
  EXPECT_EQ(a.run.k_r, b.run.k_r);
  ASSERT_EQ(a.run.scans.size(), b.run.scans.size());
  for (std::size_t i = 0; i < a.run.scans.size(); ++i) EXPECT_TRUE(same_bits(a.run.scans[i], b.run.scans[i])) << i;
}

TEST(TrialWorker, LeavesTheLinearRunsOfTheProcessThatWroteTheProblem) {
  const TemporaryDirectory directory;
  const TrialProblem problem = two_bags();
  NoiseTrial trial{0, {}, 2};
  trial.setting.imu.k_a = 1.0 / 3.0;
  write_trials(directory.file("trials"), {trial});
  run_worker(write_worker_problem(directory.file("shared"), problem), directory.file("trials"),
             directory.file("results"), directory.file("linear"));
  const LinearRunFiles files(problem, directory.file("linear"));
  const std::optional<LinearisedTrial> found = files.find(trial);
  ASSERT_TRUE(found);
  const LinearisedTrial expected = problem.run_linearised(trial);
  ASSERT_GT(expected.run.scans.size(), 3U) << "after the standstill";
  expect_same_bits(*found, expected);
  EXPECT_EQ(read_results(directory.file("results")).at(0).nll, expected.result.nll);
}

TEST(LinearRunFiles, TellOneRunFromAnother) {
  const TemporaryDirectory directory;
  const TrialProblem problem = two_bags();
  const LinearRunFiles files(problem, directory.file("linear"));
  const NoiseTrial trial{0, {}, 1};
  EXPECT_FALSE(files.find(trial));
  files.put(problem.run_linearised(trial));
  EXPECT_TRUE(files.find(trial));
  NoiseTrial other_setting = trial;
  other_setting.setting.k_r = std::nextafter(1.0, 2.0);
  for (const NoiseTrial& other : {NoiseTrial{1, {}, 1}, NoiseTrial{0, {}, 0}, other_setting})
    EXPECT_FALSE(files.find(other));
}

TEST(LinearRunFiles, WhatIsDamagedOrCutOffIsRunAgain) {
  const TemporaryDirectory directory;
  const TrialProblem problem = two_bags();
  const LinearRunFiles files(problem, directory.file("linear"));
  const NoiseTrial trial{1, {}, 0};
  const LinearisedTrial made = files.get(trial);
  const std::string path = std::filesystem::directory_iterator(directory.file("linear"))->path().string();
  const std::string whole = contents_of(path);
  for (const std::size_t length : {whole.size() - 1, whole.size() / 2, std::size_t{10}, std::size_t{0}}) {
    write_whole(path, whole.substr(0, length));
    EXPECT_FALSE(files.find(trial)) << length;
  }
  for (const std::size_t place :
       {std::size_t{3}, std::size_t{40}, std::size_t{97}, whole.size() / 2, whole.size() - 3}) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 0x40);
    write_whole(path, damaged);
    EXPECT_FALSE(files.find(trial)) << place;
  }
  write_whole(path, whole + "x");
  expect_same_bits(files.get(trial), made);
  EXPECT_EQ(contents_of(path), whole);
}

TEST(LinearRunFiles, ADirectoryThatCannotBeMadeIsNamed) {
  const TemporaryDirectory directory;
  write_whole(directory.file("file"), "");
  const TrialProblem problem = two_bags();
  EXPECT_NE(refusal([&] { LinearRunFiles(problem, directory.file("file/linear")); }).find("file/linear"),
            std::string::npos);
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
