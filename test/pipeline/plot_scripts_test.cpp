// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "allan_lio/io/csv_table.h"
#include "changed_bag.h"
#include "simulated_bag.h"

namespace allan_lio {
namespace {

constexpr double kShort = 4.0;  // [s] of the simulated bag

Outcome run_script(const std::string& command_line) {
  return run_command(ALLAN_LIO_SOURCE_DIR "/scripts/" + command_line);
}

void expect_picture(const std::string& path) {
  ASSERT_TRUE(std::filesystem::exists(path)) << path;
  const std::string bytes = contents_of(path);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n") << path;
  EXPECT_GT(bytes.size(), 10000U) << path << " holds next to nothing";
}

/// A refusal is one line that begins with the script and names the file: no traceback.
void expect_refusal(const std::string& script, const std::string& arguments, const std::string& file) {
  const Outcome outcome = run_script(script + " " + arguments);
  EXPECT_EQ(outcome.status, 1) << outcome.text;
  EXPECT_EQ(outcome.text.rfind(script + ": ", 0), 0U) << outcome.text;
  EXPECT_EQ(outcome.text.find('\n'), outcome.text.size() - 1) << outcome.text;
  EXPECT_NE(outcome.text.find(file), std::string::npos) << outcome.text;
}

/// lio_offline's results of the bag's first seconds in `directory`/run.
void make_run(const TemporaryDirectory& directory) {
  BagChange change;
  change.duration = kShort;
  change_bag(SimulatedBag::get().bag(), directory.file("short.bag"), change);
  const Outcome run = run_lio_offline(directory.file("short.bag"), directory.file("run"));
  ASSERT_EQ(run.status, 0) << run.text;
}

/// What print_figures.py says of a curve through these values.
std::string curve(const std::string& label, const std::vector<double>& values) {
  char text[200];
  std::snprintf(text, sizeof text, "  %s: %zu points, the last %.6e\n", label.c_str(), values.size(), values.back());
  return text;
}

/// The three curves of a vector's components.
std::string curves(const CsvTable& states, const std::string& vector) {
  std::string text;
  for (const char* axis : {"x", "y", "z"}) text += curve(axis, states.numbers(vector + "_" + axis));
  return text;
}

TEST(PlotScripts, BiasesNisAndLocalizabilityAreTheCurvesOfPlotStates) {
  const TemporaryDirectory directory;
  ASSERT_NO_FATAL_FAILURE(make_run(directory));
  const Outcome drawn = run_command("/usr/bin/python3 " ALLAN_LIO_SOURCE_DIR "/test/support/print_figures.py --run " +
                                    directory.file("run") + " --out " + directory.file("states"));
  ASSERT_EQ(drawn.status, 0) << drawn.text;
  const CsvTable states(directory.file("run/states.csv"));
  std::vector<double> nis, weakest(states.rows(), 1.0);
  const std::vector<double> of_scan = states.numbers_or_nan("nis"), dof = states.numbers_or_nan("nis_dof");
  for (std::size_t i = 0; i < dof.size(); ++i)
    if (dof[i] > 0.0) nis.push_back(of_scan[i] / dof[i]);
  ASSERT_FALSE(nis.empty());
  for (const std::string& name : states.names_with("support_")) {
    const std::vector<double> support = states.numbers(name);
    for (std::size_t i = 0; i < support.size(); ++i) weakest[i] = std::min(weakest[i], support[i]);
  }
  for (const std::string& shown :
       {"biases.png: Gyroscope bias, ±3 σ | bias [rad/s]\n" + curves(states, "bg"),
        "biases.png: Accelerometer bias, ±3 σ | bias [m/s²]\n" + curves(states, "ba"),
        std::string("nis.png: NIS per degree of freedom (1 is honest, above is too sure) | NIS [1]\n") +
            curve("one scan", nis) + "  mean over 100 scans: ",
        std::string("localizability.png: Localizability: share that the LiDAR decides (0 is left to the IMU) | "
                    "support [1]\n"),
        curve("weakest of the six directions", weakest)})
    EXPECT_NE(drawn.text.find(shown), std::string::npos) << shown << "is not in\n" << drawn.text;
}

TEST(PlotScripts, DrawARunOfLioOffline) {
  const TemporaryDirectory directory;
  ASSERT_NO_FATAL_FAILURE(make_run(directory));
  const std::string from = " --run " + directory.file("run") + " --out ";

  const Outcome states = run_script("plot_states" + from + directory.file("states"));
  EXPECT_EQ(states.status, 0) << states.text;
  for (const char* name : {"biases", "nis", "localizability"})
    expect_picture(directory.file("states/" + std::string(name) + ".png"));

  const Outcome alone = run_script("plot_run" + from + directory.file("alone"));
  EXPECT_EQ(alone.status, 0) << alone.text;
  for (const char* name : {"trajectory", "biases", "localizability"})
    expect_picture(directory.file("alone/" + std::string(name) + ".png"));

  const Outcome compared =
      run_script("plot_run" + from + directory.file("compared") + " --truth " + SimulatedBag::get().truth());
  EXPECT_EQ(compared.status, 0) << compared.text;
  for (const char* name : {"trajectory", "error", "biases", "localizability"})
    expect_picture(directory.file("compared/" + std::string(name) + ".png"));

  std::ofstream(directory.file("bad.tum")) << "1 2 3\n";
  expect_refusal("plot_run", from + directory.file("bad") + " --truth " + directory.file("bad.tum"), "bad.tum:1: ");
  expect_refusal("plot_run", from + directory.file("bad") + " --truth " + directory.file("none.tum"), "none.tum");
  expect_refusal("plot_run", from + directory.file("bad.tum/out"), "bad.tum");
}

TEST(PlotScripts, SayWhichFileCannotBeDrawn) {
  const TemporaryDirectory directory;
  const std::string states = directory.file("states.csv");
  const std::string arguments = "--run " + directory.path() + " --out " + directory.file("out");
  const std::string kTexts[] = {
      "t,outcome\n",                           // no row
      "t,outcome\n1.0,updated\n",              // none of the other columns
      "t,outcome\nyesterday,updated\n",        // stamps that are none
      std::string("t,\xff\xfe\0\n1,2\n", 10),  // no text
  };
  for (const char* script : {"plot_run", "plot_states"}) expect_refusal(script, arguments, "states.csv");
  for (const std::string& text : kTexts) {
    SCOPED_TRACE(text);
    std::ofstream(states, std::ios::binary) << text;
    expect_refusal("plot_run", arguments, "states.csv");
  }
  std::ofstream(states) << kTexts[1];
  expect_refusal("plot_states", arguments, "states.csv");
}

}  // namespace
}  // namespace allan_lio
