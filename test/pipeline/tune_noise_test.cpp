// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <yaml-cpp/yaml.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>
#include <thread>
#include <tuple>

#include "allan_lio/calib/noise_trial_run.h"
#include "allan_lio/io/run_program.h"
#include "allan_lio/io/trial_store.h"
#include "allan_lio/io/yaml_source.h"
#include "allan_lio/ros/prepared_bag.h"
#include "simulated_bag.h"
#include "slurm_cluster.h"

namespace allan_lio {
namespace {

const std::string kConfigs = std::string(ALLAN_LIO_SOURCE_DIR) + "/config";

LioConfig simulated_config() { return read_config(load_yaml("simulated", {kConfigs, kConfigs + "/robots"})); }

std::string on_rooms() { return "tune_noise --config simulated --bag " + SimulatedBag::get().bag(); }
std::string with_truth() { return on_rooms() + " --reference " + SimulatedBag::get().truth(); }

std::string grid_of(const std::string& values, const std::string& out) {
  return with_truth() + " --params k_gb,k_ab --search grid --grid '" + values + "' --runs 2 --profile none --out " +
         out;
}

/// What identifies no run: the command is the user's words, and differs where the directories do.
std::string without_command(const std::string& yaml) {
  std::istringstream in(yaml);
  std::string kept;
  for (std::string line; std::getline(in, line);)
    if (line.rfind("  command: ", 0) != 0) kept += line + "\n";
  return kept;
}

/// To the byte, but for the command line.
void expect_same_results(const TemporaryDirectory& a, const TemporaryDirectory& b) {
  EXPECT_EQ(contents_of(a.file("trials.csv")), contents_of(b.file("trials.csv")));
  EXPECT_EQ(without_command(contents_of(a.file("tuning.yaml"))), without_command(contents_of(b.file("tuning.yaml"))));
}

void expect_text(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) EXPECT_NE(text.find(part), std::string::npos) << part << " is not in: " << text;
}

/// tune_noise on its way, to be ended by a signal.
class Running {
 public:
  Running(const std::string& command, const std::string& directory) : status_(directory + "/status") {
    const std::string pid = directory + "/pid", script = directory + "/script";
    std::ofstream(script) << "export ROS_PACKAGE_PATH=" ALLAN_LIO_SOURCE_DIR ":$ROS_PACKAGE_PATH\necho $$ >" << pid
                          << "\nexec " ALLAN_LIO_BIN_DIR "/" << command << "\n";
    run_command("(sh " + script + " >" + directory + "/log 2>&1; echo $? >" + status_ + ".part; mv " + status_ +
                ".part " + status_ + ") >/dev/null 2>&1 &");
    for (int i = 0; i < 200 && pid_ <= 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      std::ifstream(pid) >> pid_;
    }
  }

  /// Waits until so many trials are in the store, sends the signal and waits for the end. Gives the shell's status.
  int end(int signal, const std::string& store, std::size_t trials) const {
    return end(signal, [&] { return std::filesystem::exists(store) && TrialStore(store).size() >= trials; });
  }

  /// Waits until it is time, sends the signal and waits for the end.
  int end(int signal, const std::function<bool()>& is_time) const {
    for (int i = 0; i < 3000 && !std::filesystem::exists(status_) && !is_time(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (!std::filesystem::exists(status_)) kill(pid_, signal);
    for (int i = 0; i < 3000 && !std::filesystem::exists(status_); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    int status = -1;
    std::ifstream(status_) >> status;
    return status;
  }

 private:
  std::string status_;
  pid_t pid_ = -1;
};

TEST(TuneNoise, TheGridsTableIsWhatRunningEachSettingByHandGives) {
  const TemporaryDirectory out;
  const Outcome run = run_tool(grid_of("k_gb=1,30;k_ab=5", out.path()));
  ASSERT_EQ(run.status, 0) << run.text;
  expect_text(run.text, {"best: k_g 1, k_a 1, k_gb ", "ATE max", "rooms.bag: ATE "});
  const YAML::Node tuning = YAML::LoadFile(out.file("tuning.yaml"));
  ASSERT_EQ(tuning["evaluations"].size(), 2U);
  const PreparedBag bag = prepare_bag({SimulatedBag::get().bag()}, simulated_config(), SimulatedBag::get().truth());
  for (std::size_t i = 0; i < 2; ++i) {
    NoiseTrial trial;
    trial.setting.imu.k_gb = i == 0 ? 1.0 : 30.0;
    trial.setting.imu.k_ab = 5.0;
    double sum = 0.0;
    for (trial.run = 0; trial.run < 2; ++trial.run) sum += run_trial(bag.record, simulated_config(), trial, 1).ate;
    EXPECT_EQ(tuning["evaluations"][i]["setting"]["k_gb"].as<double>(), trial.setting.imu.k_gb);
    EXPECT_EQ(tuning["evaluations"][i]["objective"].as<double>(), sum / 2.0);
  }
  const std::string trials = contents_of(out.file("trials.csv"));
  EXPECT_EQ(std::count(trials.begin(), trials.end(), '\n'), 5) << trials;
}

TEST(TuneNoise, LeavesASettingToIncludeAReportAndTrajectories) {
  const TemporaryDirectory out;
  ASSERT_EQ(run_tool(grid_of("k_gb=30;k_ab=5", out.path())).status, 0);
  std::ofstream(out.file("robot.yaml")) << "include: [simulated, best.yaml]\n";
  const LioConfig config = read_config(load_yaml(out.file("robot.yaml"), {kConfigs, kConfigs + "/robots"}));
  EXPECT_EQ(config.imu.scale.k_gb, 30.0);
  EXPECT_EQ(config.imu.scale.k_ab, 5.0);
  expect_text(contents_of(out.file("report.html")), {"<html", "k_gb: 30", "</html>"});
  for (const char* file : {"before_0.tum", "after_0.tum"}) EXPECT_EQ(read_tum(out.file(file)).size(), 200U) << file;
  EXPECT_FALSE(contents_of(out.file("before_0.tum")) == contents_of(out.file("after_0.tum")));
}

TEST(TuneNoise, KilledAndStartedAgainItEndsWithTheSameResultToTheLastDigit) {
  const TemporaryDirectory whole, killed;
  const std::string values = "k_gb=1,3,30;k_ab=1,10";
  ASSERT_EQ(run_tool(grid_of(values, whole.path())).status, 0);
  const Running running(grid_of(values, killed.path()) + " --jobs 1", killed.path());
  EXPECT_EQ(running.end(SIGKILL, killed.file("trials.sqlite"), 3), 128 + SIGKILL) << contents_of(killed.file("log"));
  const std::size_t before = TrialStore(killed.file("trials.sqlite")).size();
  EXPECT_GE(before, 3U);
  EXPECT_LT(before, 12U);
  const Outcome again = run_tool(grid_of(values, killed.path()));
  ASSERT_EQ(again.status, 0) << again.text;
  expect_same_results(killed, whole);
}

std::map<std::string, std::filesystem::file_time_type> files_in(const std::string& directory) {
  std::map<std::string, std::filesystem::file_time_type> found;
  if (std::filesystem::exists(directory))
    for (const auto& entry : std::filesystem::directory_iterator(directory))
      found[entry.path().filename().string()] = entry.last_write_time();
  return found;
}

TEST(TuneNoise, ALikelihoodSearchThatWasInterruptedGoesOnWithTheRunsThatItHas) {
  const TemporaryDirectory whole, interrupted;
  const std::string likelihood = with_truth() + " --params k_g,k_a --runs 2 --jobs 1 --out ";
  ASSERT_EQ(run_tool(likelihood + whole.path()).status, 0);
  const std::size_t all = files_in(whole.file("linear")).size();
  ASSERT_GE(all, 4U);
  const Running running(likelihood + interrupted.path(), interrupted.path());
  EXPECT_EQ(running.end(SIGTERM, [&] { return !files_in(interrupted.file("linear")).empty(); }), 130)
      << contents_of(interrupted.file("log"));
  const auto before = files_in(interrupted.file("linear"));
  EXPECT_LT(before.size(), all);
  const Outcome again = run_tool(likelihood + interrupted.path());
  ASSERT_EQ(again.status, 0) << again.text;
  expect_same_results(interrupted, whole);
  const auto after = files_in(interrupted.file("linear"));
  EXPECT_EQ(after.size(), all);
  for (const auto& [name, time] : before) EXPECT_EQ(after.at(name), time) << name << " was made again";
}

TEST(TuneNoise, WhatIsInTheStoreIsNotRunAgain) {
  const TemporaryDirectory out;
  const std::string command = grid_of("k_gb=1,30;k_ab=5", out.path());
  ASSERT_EQ(run_tool(command).status, 0);
  sqlite3* store = nullptr;
  ASSERT_EQ(sqlite3_open(out.file("trials.sqlite").c_str(), &store), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(store, "UPDATE trials SET ate = 0.125", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(store);
  ASSERT_EQ(run_tool(command).status, 0);
  EXPECT_EQ(YAML::LoadFile(out.file("tuning.yaml"))["best"]["objective"].as<double>(), 0.125) << "from the store";
  ASSERT_EQ(run_tool(command + " --seed 2").status, 0) << "other variations of the runs";
  EXPECT_EQ(TrialStore(out.file("trials.sqlite")).size(), 4U + 2U) << "run 0 has none";
}

TEST(TuneNoise, InterruptedItWritesWhatThereIs) {
  const TemporaryDirectory out;
  const Running running(grid_of("k_gb=1,3,30;k_ab=1,10,20", out.path()) + " --jobs 1", out.path());
  EXPECT_EQ(running.end(SIGTERM, out.file("trials.sqlite"), 4), 130) << contents_of(out.file("log"));
  expect_text(contents_of(out.file("log")), {"interrupted", "the same command goes on"});
  const YAML::Node tuning = YAML::LoadFile(out.file("tuning.yaml"));
  EXPECT_EQ(tuning["best"]["end"].as<std::string>(), "interrupted");
  EXPECT_GE(tuning["evaluations"].size(), 2U);
  EXPECT_LT(tuning["evaluations"].size(), 9U);
  EXPECT_FALSE(std::filesystem::exists(out.file("best.yaml"))) << "nothing was found yet";
}

TEST(TuneNoise, OnLinearRunsItRunsTheFilterOnceARound) {
  const TemporaryDirectory out;
  const Outcome run = run_tool(with_truth() + " --params k_g,k_a --out " + out.path());
  ASSERT_EQ(run.status, 0) << run.text;
  expect_text(run.text, {"on the linear filter of", "from scan to scan", "rooms.bag: ATE"});
  const YAML::Node tuning = YAML::LoadFile(out.file("tuning.yaml"));
  const std::size_t rounds = tuning["rounds"].size();
  ASSERT_GE(rounds, 2U) << "the first knows nothing of how far errors hang together";
  EXPECT_LE(rounds, 6U);
  expect_text(run.text, {"of " + std::to_string(rounds) + " rounds with " + std::to_string(rounds) + " runs"});
  EXPECT_EQ(tuning["rounds"][0]["at"]["k_g"].as<double>(), 1.0);
  for (std::size_t i = 1; i < rounds; ++i)
    EXPECT_EQ(YAML::Dump(tuning["rounds"][i]["at"]), YAML::Dump(tuning["rounds"][i - 1]["found"]));
  EXPECT_EQ(YAML::Dump(tuning["rounds"][rounds - 1]["found"]), YAML::Dump(tuning["best"]["setting"]));
  ASSERT_EQ(tuning["profiles"].size(), 2U);
  for (const YAML::Node& profile : tuning["profiles"]) EXPECT_TRUE(profile["scan_interval"]) << YAML::Dump(profile);
  const std::string trials = contents_of(out.file("trials.csv"));
  EXPECT_EQ(std::count(trials.begin(), trials.end(), '\n'), 1 + static_cast<long>(rounds)) << trials;
  EXPECT_EQ(trials.find(",nan,"), std::string::npos) << "runs of the filter have an error: " << trials;
  expect_text(contents_of(out.file("report.html")), {"Rounds", "a drift of the map"});
}

TEST(TuneNoise, RerunRunsTheFilterWithEverySetting) {
  const TemporaryDirectory out;
  const Outcome run = run_tool(on_rooms() + " --params k_g --rerun --budget 6 --profile none --out " + out.path());
  ASSERT_EQ(run.status, 0) << run.text;
  const YAML::Node tuning = YAML::LoadFile(out.file("tuning.yaml"));
  EXPECT_EQ(tuning["rounds"].size(), 0U);
  const std::string trials = contents_of(out.file("trials.csv"));
  EXPECT_EQ(std::count(trials.begin(), trials.end(), '\n'), 1 + static_cast<long>(tuning["evaluations"].size()));
}

TEST(TuneNoise, BagsHeldOutAreScoredAndNotTunedOn) {
  const TemporaryDirectory alone, with;
  const std::string likelihood = on_rooms() + " --params k_g --budget 8 --profile none --out ";
  ASSERT_EQ(run_tool(likelihood + alone.path()).status, 0);
  const Outcome run = run_tool(likelihood + with.path() + " --hold-out " + SimulatedBag::get().bag());
  ASSERT_EQ(run.status, 0) << run.text;
  expect_text(run.text, {"rooms.bag (held out): NLL"});
  const YAML::Node without = YAML::LoadFile(alone.file("tuning.yaml")), held = YAML::LoadFile(with.file("tuning.yaml"));
  EXPECT_EQ(YAML::Dump(held["evaluations"]), YAML::Dump(without["evaluations"]));
  const auto share = without["problem"]["nll_scale"].as<double>();
  EXPECT_TRUE(share > 0.05 && share <= 1.0) << share;
  EXPECT_EQ(without["before_after"]["bags"].size(), 1U);
  ASSERT_EQ(held["before_after"]["bags"].size(), 2U);
  EXPECT_EQ(held["before_after"]["bags"][1]["after"]["horizon_nll"].as<double>(),
            held["before_after"]["bags"][0]["after"]["horizon_nll"].as<double>());
}

TEST(TuneNoise, TheLikelihoodFromScanToScanIsAskedForByItsName) {
  const TemporaryDirectory horizons, scans;
  const std::string grid = on_rooms() + " --params k_g --search grid --grid 0.5,1 --profile none --nll-scale 1";
  ASSERT_EQ(run_tool(grid + " --objective nll --out " + horizons.path()).status, 0);
  ASSERT_EQ(run_tool(grid + " --objective scan_nll --out " + scans.path()).status, 0);
  for (const auto& [out, objective, figure] :
       {std::tuple(&horizons, "nll", "horizon_nll"), std::tuple(&scans, "scan_nll", "nll")}) {
    const YAML::Node tuning = YAML::LoadFile(out->file("tuning.yaml"));
    EXPECT_EQ(tuning["problem"]["objective"].as<std::string>(), objective);
    // At k = 1 there is no prior, and the configuration's noise is that.
    EXPECT_EQ(tuning["evaluations"][1]["objective"].as<double>(),
              tuning["before_after"]["bags"][0]["before"][figure].as<double>());
  }
}

TEST(TuneNoise, ASuiteIsSimulatedReadAndRemoved) {
  const TemporaryDirectory out;
  std::ofstream(out.file("tiny.yaml"))
      << "defaults: {imu: mti600, lidar: velodyne16, duration: 6}\n"
         "sequences:\n  a: {scene: rooms, params: {lidar/leaf: 0.5}}\n  b: {scene: city}\n";
  const std::string command = "tune_noise --suite " + out.file("tiny.yaml") +
                              " --seeds 1 --only a --hold-out-seeds 2 --params k_gb --search grid --grid 1,9 --out " +
                              out.file("out");
  const Outcome run = run_tool(command);
  ASSERT_EQ(run.status, 0) << run.text;
  expect_text(run.text, {"a_1: ATE", "a_2 (held out): ATE"});
  const std::string trials = contents_of(out.file("out/trials.csv"));
  const auto records = [&out] { return files_in(out.file("out/records")); };
  const auto made = records();
  ASSERT_EQ(made.size(), 2U) << "of the bags only the prepared records are left";
  EXPECT_EQ(made.begin()->first.substr(made.begin()->first.size() - 4), ".bin");
  ASSERT_EQ(run_tool(command).status, 0);
  EXPECT_EQ(contents_of(out.file("out/trials.csv")), trials);
  EXPECT_EQ(records(), made) << "they were not made again";
}

TEST(TuneNoise, SlurmGivesTheLocalEnginesResultsTrialByTrial) {
  if (!SlurmCluster::installed()) GTEST_SKIP() << "slurmctld is not installed (package slurm-wlm)";
  const TemporaryDirectory local, slurm;
  const std::string values = "k_gb=1,30;k_ab=1,10";
  ASSERT_EQ(run_tool(grid_of(values, local.path())).status, 0);
  const SlurmCluster cluster;
  const Outcome run = run_tool(grid_of(values, slurm.path()) + " --engine slurm --slurm-poll 0.1 --slurm-directory " +
                               shell_quoted(slurm.file("it's shared")));
  ASSERT_EQ(run.status, 0) << run.text;
  expect_same_results(slurm, local);

  // A likelihood search: runs whose linear runs come through the shared directory.
  const TemporaryDirectory linear_local, linear_slurm;
  const std::string likelihood = with_truth() + " --params k_g --profile none --out ";
  ASSERT_EQ(run_tool(likelihood + linear_local.path()).status, 0);
  const Outcome linear = run_tool(likelihood + linear_slurm.path() + " --engine slurm --slurm-poll 0.1");
  ASSERT_EQ(linear.status, 0) << linear.text;
  expect_same_results(linear_slurm, linear_local);
  EXPECT_EQ(files_in(linear_slurm.file("slurm/linear")).size(), files_in(linear_local.file("linear")).size());
  EXPECT_FALSE(std::filesystem::exists(linear_slurm.file("linear"))) << "no run was made here";
}

TEST(TuneNoise, BadUseIsToldAndEndsWithTwo) {
  const TemporaryDirectory directory;
  const std::string out = " --out " + directory.file("out"), bag = " --bag b.bag", config = " --config simulated";
  const std::string suite = ALLAN_LIO_SOURCE_DIR "/config/suites/degenerate.yaml";
  const std::vector<std::pair<std::string, std::vector<std::string>>> uses = {
      {"--params k_gb" + out + config, {"either --bag or --suite"}},
      {"--params k_gb" + bag + config, {"--out is needed"}},
      {bag + config + out, {"--params is needed"}},
      {"--params k_gb" + bag + out, {"--config is needed"}},
      {"--params k_x" + bag + config + out, {"--params", "k_x", "k_gb"}},
      {"--params k_gb,k_gb" + bag + config + out, {"k_gb is given twice"}},
      {"--params k_gb --search grid --grid 1,3" + bag + config + out, {"objective ate", "--reference"}},
      {"--params k_gb --search grid --objective nll" + bag + config + out, {"needs --grid"}},
      {"--params k_gb --grid 1" + bag + config + out, {"--grid is for"}},
      {"--params k_gb --search grid --objective nll --grid 1,9000" + bag + config + out, {"9000", "--box"}},
      {"--params k_gb --search grid --objective nll --grid 1,x" + bag + config + out, {"--grid", "'x'"}},
      {"--params k_gb --reference a.tum --reference b.tum" + bag + config + out, {"1 bags and 2 references"}},
      {"--params k_gb --start k_ab=3" + bag + config + out, {"--start", "k_ab is not tuned"}},
      {"--params k_gb --order k_gb" + bag + config + out, {"--order is for"}},
      {"--params k_gb --search annealing" + bag + config + out, {"--search"}},
      {"--params k_gb --search bayes --rerun" + bag + config + out, {"--rerun is for"}},
      {"--params k_gb --runs 0" + bag + config + out, {"--runs"}},
      {"--params k_gb --seeds 3" + bag + config + out, {"need --suite"}},
      {"--params k_gb --only moon --suite " + suite + out, {"--suite", "no sequence 'moon'"}},
      {"--params k_gb --config moon" + bag + out, {"moon"}},
      {"--params k_gb --param imu/k_gx=1" + bag + config + out, {"imu/k_gx"}},
      {"--params k_gb --nll-scale much" + bag + config + out, {"--nll-scale", "much"}},
  };
  for (const auto& [use, parts] : uses) {
    const Outcome run = run_tool("tune_noise " + use);
    EXPECT_EQ(run.status, 2) << use << ": " << run.text;
    expect_text(run.text, parts);
    EXPECT_EQ(run.text.rfind("tune_noise: ", 0), 0U) << run.text;
  }
  const Outcome missing = run_tool("tune_noise --params k_gb" + bag + config + out);
  EXPECT_EQ(missing.status, 1);
  expect_text(missing.text, {"b.bag"});
}

}  // namespace
}  // namespace allan_lio
