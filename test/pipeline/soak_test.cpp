// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <memory>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

/// Two laps of the soak, in which the second one goes on where the first one ended.
class SoakTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    directory_ = std::make_unique<TemporaryDirectory>();
#ifdef __SANITIZE_ADDRESS__
    // It keeps back what is freed, up to 256 MB, which would be taken for growth.
    const char* options = std::getenv("ASAN_OPTIONS");
    setenv("ASAN_OPTIONS",
           (std::string(options == nullptr ? "" : options) + ":quarantine_size_mb=1:thread_local_quarantine_size_kb=16")
               .c_str(),
           1);
#endif
    outcome_ = bench("--hours 0.03 --warm-up 60 --out " + directory_->file("run"));
  }
  static void TearDownTestSuite() { directory_.reset(); }

  static Outcome bench(const std::string& arguments) {
    return run_command("/usr/bin/python3 " ALLAN_LIO_SOURCE_DIR "/scripts/bench --soak --bin " ALLAN_LIO_BIN_DIR " " +
                       arguments);
  }

  /// The run as it is judged when `file` of it is changed.
  static Outcome judged_with(const std::string& file, const std::function<std::string(std::string)>& change) {
    const std::string copy = directory_->file("changed");
    fs::remove_all(copy);
    fs::copy(directory_->file("run"), copy, fs::copy_options::recursive);
    const std::string changed = change(contents_of(copy + "/" + file));
    std::ofstream(copy + "/" + file) << changed;
    return bench("--judge --warm-up 60 --out " + copy);
  }

  /// The line of the table that is broken when `file` of the run is changed.
  static std::string broken_by(const std::string& file, const std::function<std::string(std::string)>& change) {
    const Outcome judged = judged_with(file, change);
    EXPECT_NE(judged.status, 0) << file;
    std::istringstream lines(judged.text);
    for (std::string line; std::getline(lines, line);)
      if (line.find("BROKEN") != std::string::npos) return line;
    return judged.text;
  }

  static std::unique_ptr<TemporaryDirectory> directory_;
  static Outcome outcome_;
};

std::unique_ptr<TemporaryDirectory> SoakTest::directory_;
Outcome SoakTest::outcome_;

/// A column of a CSV's rows as a function of their first one.
std::string with_column(const std::string& csv, int column, const std::function<double(double)>& value) {
  std::istringstream in(csv);
  std::ostringstream out;
  std::string line;
  std::getline(in, line);
  out << line << '\n' << std::setprecision(12);
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    for (std::size_t k = 0; k < cells.size(); ++k) {
      out << (k == 0 ? "" : ",");
      if (static_cast<int>(k) == column)
        out << value(std::stod(cells[0]));
      else
        out << cells[k];
    }
    out << '\n';
  }
  return out.str();
}

std::string with(std::string text, const std::string& old_part, const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << old_part;
  return at == std::string::npos ? text : text.replace(at, old_part.size(), new_part);
}

TEST_F(SoakTest, TwoLapsOfTheNodeletsKeepTheirLimits) {
  ASSERT_EQ(outcome_.status, 0) << outcome_.text;
  EXPECT_EQ(outcome_.text.find("BROKEN"), std::string::npos) << outcome_.text;
  EXPECT_NE(outcome_.text.find("2 laps of 79.105 s"), std::string::npos) << outcome_.text;
  EXPECT_NE(outcome_.text.find("| scans used of read | 1582 of 1582 |"), std::string::npos) << outcome_.text;
  EXPECT_EQ(contents_of(directory_->file("run/soak.png")).substr(1, 3), "PNG");
}

TEST_F(SoakTest, EveryLimitCanBreak) {
  ASSERT_EQ(outcome_.status, 0) << outcome_.text;
  const auto column = [](int k, double offset, double slope) {
    return [=](const std::string& csv) { return with_column(csv, k, [=](double t) { return offset + slope * t; }); };
  };
  EXPECT_NE(broken_by("soak.csv", column(2, 50.0, 2.0 / 3600.0)).find("RSS"), std::string::npos) << "2 MB/h";
  EXPECT_NE(broken_by("soak.csv", column(3, 1.01, 0.0)).find("map"), std::string::npos);
  EXPECT_NE(broken_by("soak.csv", column(4, 1.1, 0.0)).find("lag"), std::string::npos);
  const auto state_row = [](const std::string& pattern, const std::string& changed) {
    return [=](const std::string& csv) { return std::regex_replace(csv, std::regex(pattern), changed); };
  };
  const std::string row = "(/lidar_odometry/state,\\d+,)";
  EXPECT_NE(broken_by("topics.csv", state_row(row + "0", "$017")).find("lost"), std::string::npos);
  EXPECT_NE(broken_by("topics.csv", state_row(row + "0,(\\d+),0", "$010,$02,7")).find("NaN"), std::string::npos);
  EXPECT_NE(
      broken_by("run/summary.yaml", [](const std::string& text) { return with(text, "skipped: 0", "skipped: 1"); })
          .find("scans used"),
      std::string::npos);
  EXPECT_NE(broken_by("run/summary.yaml",
                      [](const std::string& text) { return with(text, "\"complete\"", "\"interrupted\""); })
                .find("simulated"),
            std::string::npos);
  EXPECT_NE(broken_by("imu_answers.csv", [](const std::string&) { return "superseded,lost\n0,1\n"; }).find("answer"),
            std::string::npos);
}

/// 80 s of a swing of two megabytes look like 90 MB/h, by four times the error of the fit: no finding. Ten megabytes
/// are.
TEST_F(SoakTest, AShortRunsSwingIsNotTakenForGrowth) {
  ASSERT_EQ(outcome_.status, 0) << outcome_.text;
  const auto rising_by = [](double rise) {
    return [rise](const std::string& csv) {
      return with_column(csv, 2, [rise](double t) { return 54.6 + (t > 100.0 ? rise : 0.0) + 0.1 * std::sin(t); });
    };
  };
  const Outcome swing = judged_with("soak.csv", rising_by(2.0));
  EXPECT_EQ(swing.status, 0) << swing.text;
  EXPECT_NE(swing.text.find("too short a run to show it | ok"), std::string::npos) << swing.text;
  EXPECT_NE(broken_by("soak.csv", rising_by(10.0)).find("RSS"), std::string::npos);
}

TEST_F(SoakTest, ATrajectoryThatRunsAwayIsSeen) {
  ASSERT_EQ(outcome_.status, 0) << outcome_.text;
  const auto run_away = [](const std::string& tum) {
    std::istringstream in(tum);
    std::ostringstream out;
    double shift = 0.0;
    for (std::string line; std::getline(in, line); shift += 0.001) {
      std::istringstream row(line);
      std::string stamp, x, rest;
      row >> stamp >> x;
      std::getline(row, rest);
      out << stamp << ' ' << std::stod(x) + shift << rest << '\n';
    }
    return out.str();
  };
  EXPECT_NE(broken_by("run/trajectory.tum", run_away).find("position"), std::string::npos);
}

}  // namespace
}  // namespace allan_lio
