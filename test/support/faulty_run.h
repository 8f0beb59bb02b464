// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "allan_lio/eval/trajectory_error.h"
#include "allan_lio/io/tum.h"
#include "bag_mutator.h"
#include "simulated_bag.h"

namespace allan_lio {

/// lio_offline on the simulated bag with faults (see fault_by_name()), and what it wrote.
class FaultyRun {
 public:
  explicit FaultyRun(const std::vector<std::string>& faults, const std::string& more = "") {
    std::vector<Mutation> mutations;
    for (const std::string& name : faults) mutations.push_back(fault_by_name(name));
    const std::string bag = directory_.file("faulty.bag");
    mutate_bag(SimulatedBag::get().bag(), bag, mutations);
    outcome_ = run_lio_offline(bag, directory_.file("out"), more);
    summary_ = YAML::LoadFile(file("summary.yaml"));
  }

  const Outcome& outcome() const { return outcome_; }
  std::string file(const std::string& name) const { return directory_.file("out/" + name); }
  std::string status() const { return summary_["status"].as<std::string>(); }
  int scans(const std::string& key) const { return summary_["scans"][key].as<int>(); }
  int skipped(const std::string& why) const { return summary_["scans"]["skipped_because"][why].as<int>(); }
  int points(const std::string& key) const { return summary_["points"][key].as<int>(); }
  int imu(const std::string& key) const { return summary_["imu"][key].as<int>(); }

  /// All notes of the summary, one a line.
  std::string notes() const {
    std::string out;
    for (const auto& note : summary_["notes"]) out += note.as<std::string>() + "\n";
    return out;
  }

  Trajectory trajectory() const { return read_tum(file("trajectory.tum")); }

  /// Rows of states.csv with this outcome.
  std::ptrdiff_t rows_with(const std::string& outcome) const {
    std::istringstream in(contents_of(file("states.csv")));
    std::ptrdiff_t rows = 0;
    for (std::string line; std::getline(in, line);) {
      std::istringstream fields(line);
      for (std::string field; std::getline(fields, field, ',');) rows += field == outcome ? 1 : 0;
    }
    return rows;
  }

  /// The run ended in order, and nothing that it wrote is NaN or inf.
  void expect_in_order() const {
    EXPECT_EQ(outcome_.status, 0) << outcome_.text;
    EXPECT_EQ(status(), "complete");
    for (const char* name : {"states.csv", "trajectory.tum"}) {
      std::istringstream in(contents_of(file(name)));
      std::string line;
      std::getline(in, line);  // names, which may hold these letters
      while (std::getline(in, line))
        EXPECT_TRUE(line.find("nan") == std::string::npos && line.find("inf") == std::string::npos) << line;
    }
  }

 private:
  TemporaryDirectory directory_;
  Outcome outcome_;
  YAML::Node summary_;
};

/// Root mean square of the positions' errors after the best rigid fit [m].
inline double ate_of(const Trajectory& estimate) {
  return evaluate_trajectory(read_tum(SimulatedBag::get().truth()), estimate, Alignment::kSe3).translation.rmse;
}

}  // namespace allan_lio
