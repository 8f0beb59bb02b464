// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "child_process.h"
#include "temporary_directory.h"

namespace allan_lio {
namespace {

const char* const kLeast = "problem: {bags: [{name: a.bag}]}\nbest: {setting: {k_gb: 2.5}}\n";

const char* const kProblem = R"(problem:
  bags: [{name: "<script>alert(1)</script>&'\"$x$", hash: 8a61}]
  hold_out: [{name: hall.bag, hash: 77bb}]
  config: ouster.yaml
  parameters: [k_gb, k_ab]
  search: grid
  objective: OBJECTIVE
  runs: 2
  seed: 1
  command: tune_noise --bag "<script>" --seed 1
  versions: {allan_lio: 0.1.0}
  hashes: {problem: '0011'}
best: {setting: {k_g: 1, k_a: 1, k_gb: 10, k_ab: 3, k_r: 1}, objective: 0.5, end: converged}
)";

const char* const kResults = R"(profiles:
  - {parameter: k_gb, points: [[1, 9], [10, 5.5], [30, .nan], [100, 9.5]], interval: [4, 25], verdict: "told <b>"}
  - {parameter: k_ab, points: [[1, 5.6], [3, 5.5], [30, 5.5]], interval: [null, null], verdict: cannot be told}
before_after:
  before: {k_gb: 1, k_ab: 1}
  bags:
    - bag: 0
      reference: truth.tum
      before: {trajectory: before.tum, ate: 1.5, nll: 20, nis: 500, dof: 100, horizon_nis: 150, horizon_dof: 75.5}
      after: {trajectory: after.tum, ate: 0.25, nll: 10, nis: 110, dof: 100, horizon_nis: 75, horizon_dof: 75}
    - bag: 1
      before: {ate: 1.75, horizon_nll: 30, nis: 300, dof: 100, horizon_nis: 120, horizon_dof: 80}
      after: {ate: 0.375, horizon_nll: 15, nis: 90, dof: 100, horizon_nis: 100, horizon_dof: 80}
)";

/// A directory as tune_noise leaves it, with whatever parts of it a test writes.
struct TuneReport : testing::Test {
  void write(const std::string& name, const std::string& text) const { std::ofstream(directory.file(name)) << text; }

  void write_all(const std::string& objective) const {
    std::string yaml = kProblem;
    yaml.replace(yaml.find("OBJECTIVE"), 9, objective);
    std::string trials =
        "bag,run,k_g,k_a,k_gb,k_ab,k_r,ate,end_error,nll,nis,nis_dof,horizon_nll,horizon_nis,horizon_dof,"
        "horizon_share,scans,diverged\n";
    yaml += "evaluations:\n";
    for (const std::string gb : {"1", "10", "50"})
      for (const std::string ab : {"1", "3"}) {
        const std::string k = "1,1," + gb + "," + ab + ",1,";
        const std::string ends = gb == "50" ? "nan,nan,9,9,9,9,9,9,1,9,1\n" : ",1,9,9,9,9,9,9,1,9,0\n";
        const std::string ate = gb == "50" ? "" : gb == "10" ? "0.4" : "2.4", more = gb == "50" ? "" : "375";
        trials += "0,0," + k + ate + ends + "0,1," + k + ate + more + ends + "1,0," + k + "77.5,1,9,9,9,9,9,9,1,9,0\n";
        yaml += "  - {setting: {k_gb: " + gb + ", k_ab: " + ab + "}, objective: " + gb + "." + ab + "}\n";
      }
    write("tuning.yaml", yaml + kResults);
    write("trials.csv", trials);
    for (const char* name : {"truth.tum", "before.tum", "after.tum"}) write_path(name);
  }

  void write_path(const std::string& name) const {
    std::ofstream out(directory.file(name));
    const double bend = name == "truth.tum" ? 0.0 : name == "before.tum" ? 0.02 : 0.005;
    for (int i = 0; i < 50; ++i)
      out << 100 + i << " " << i << " " << 5 * std::sin(0.2 * i) + bend * i * i << " 0 0 0 0 1\n";
  }

  Outcome run() const { return run_command(ALLAN_LIO_SOURCE_DIR "/scripts/tune_report " + directory.path()); }

  std::string page() const {
    const Outcome outcome = run();
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    return contents_of(directory.file("report.html"));
  }

  TemporaryDirectory directory;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; ++at) ++found;
  return found;
}

TEST_F(TuneReport, ShowsEverySectionInAPageThatIsWellFormedAndNeedsNoOtherFile) {
  for (const char* objective : {"ate", "nll", "scan_nll"}) {
    write_all(objective);
    const std::string html = page();
    for (const char* id : {"best", "settings", "heat-map", "profiles", "nis", "trajectories", "hold-out", "repeat"})
      EXPECT_TRUE(has(html, "<section id=\"" + std::string(id) + "\">")) << id;
    EXPECT_FALSE(has(html, "class=\"missing\"")) << objective;
    EXPECT_FALSE(has(html, "http"));
    EXPECT_EQ(count(html, "<img "), 5U) << "heat map, two profiles, NIS, trajectories";
    EXPECT_EQ(count(html, "<img "), count(html, "src=\"data:image/svg+xml;base64,"));
    EXPECT_EQ(count(html, "<img "), count(html, " alt=\""));
    const Outcome parsed = run_command(
        "/usr/bin/python3 -c 'import sys, xml.etree.ElementTree as tree; "
        "tree.parse(sys.argv[1])' " +
        directory.file("report.html"));
    EXPECT_EQ(parsed.status, 0) << parsed.text;
  }
}

TEST_F(TuneReport, GivesTheBestSettingAsYamlAndThePapersTableWithoutHeldOutRuns) {
  write_all("ate");
  const std::string html = page();
  EXPECT_TRUE(has(html, "imu:\n  k_g: 1.0\n  k_a: 1.0\n  k_gb: 10.0\n  k_ab: 3.0\nlidar:\n  k_r: 1.0\n"));
  EXPECT_TRUE(
      has(html, "<tr class=\"best\"><td>10</td><td>3</td><td>0.4375</td><td>0.4</td><td>0.4188</td><td>-</td>"));
  EXPECT_TRUE(has(html, "<td>50</td><td>1</td><td>-</td><td>-</td><td>-</td><td>2 of 2</td>"));
  EXPECT_FALSE(has(html, "77.5")) << "a held-out bag's error";
  EXPECT_TRUE(has(html, "1.5 → 0.25 m"));
  EXPECT_TRUE(has(html,
                  "<td "
                  "class=\"text\">hall.bag</td><td>1.75</td><td>0.375</td><td>30</td><td>15</td><td>1.5</td><td>1.25</"
                  "td><td>3</td><td>0.9</td>"));
  EXPECT_TRUE(has(html, "95 % interval 4 to 25")) << "profile of k_gb";
  EXPECT_TRUE(has(html, "95 % interval open to open")) << "profile of k_ab";
}

TEST_F(TuneReport, EscapesWhatFilesSay) {
  write_all("nll");
  const std::string html = page();
  EXPECT_FALSE(has(html, "<script"));
  EXPECT_FALSE(has(html, "<b>\""));
  EXPECT_TRUE(has(html, "&lt;script&gt;alert(1)&lt;/script&gt;&amp;&#x27;&quot;$x$"));
}

TEST_F(TuneReport, SaysWhatIsMissing) {
  write("tuning.yaml", kLeast);
  const std::string html = page();
  EXPECT_TRUE(has(html, "k_gb: 2.5"));
  EXPECT_EQ(count(html, "class=\"missing\""), 7U) << "every section but the best setting's";
  EXPECT_EQ(count(html, "<img "), 0U);
}

TEST_F(TuneReport, LeavesOutATrajectoryThatCannotBeRead) {
  write_all("ate");
  write("after.tum", "1 2 3\n");
  EXPECT_TRUE(has(page(), "Left out: " + directory.file("after.tum") + ": holds no poses of 8 numbers."));
}

TEST_F(TuneReport, IsTheSameForTheSameFiles) {
  write_all("nll");
  const std::string first = page();
  EXPECT_EQ(page(), first);
}

TEST_F(TuneReport, NamesTheFileThatItCannotUseAndKeepsTheOldReport) {
  write("report.html", "old");
  for (const char* yaml : {"", "a: [", "problem: 3\n", "problem: {bags: 3}\nbest: {setting: {}}\n",
                           "problem: {bags: [3]}\nbest: {setting: {}}\n", "problem: {}\nbest: {setting: {k_g: x}}\n"}) {
    write("tuning.yaml", yaml);
    const Outcome outcome = run();
    EXPECT_EQ(outcome.status, 1) << yaml;
    EXPECT_EQ(outcome.text.find("tune_report: " + directory.file("tuning.yaml") + ": "), 0U) << outcome.text;
  }
  write("tuning.yaml", kLeast);
  write("trials.csv", "bag,run\n0,0\n");
  EXPECT_TRUE(has(run().text, "trials.csv: has no column k_g"));
  EXPECT_EQ(contents_of(directory.file("report.html")), "old");
}

}  // namespace
}  // namespace allan_lio
