// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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

TEST(PlotScripts, DrawARunOfLioOffline) {
  const TemporaryDirectory directory;
  BagChange change;
  change.duration = kShort;
  change_bag(SimulatedBag::get().bag(), directory.file("short.bag"), change);
  const Outcome run = run_lio_offline(directory.file("short.bag"), directory.file("run"));
  ASSERT_EQ(run.status, 0) << run.text;
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
