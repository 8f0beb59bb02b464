// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "child_process.h"

namespace allan_lio {
namespace {

namespace fs = std::filesystem;

const std::string kRoot = ALLAN_LIO_SOURCE_DIR;

/// The C++ files below a folder of the source tree.
std::vector<std::string> cpp_files(const std::string& folder) {
  std::vector<std::string> files;
  if (!fs::is_directory(kRoot + "/" + folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot + "/" + folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".h" || extension == ".cpp") files.push_back(entry.path().string());
  }
  return files;
}

std::vector<std::string> core_files() {
  std::vector<std::string> files;
  for (const char* layer : {"math", "imu", "lidar", "map", "lio", "calib", "eval", "io", "sim"})
    for (const char* tree : {"include/allan_lio/", "src/"})
      for (const std::string& file : cpp_files(std::string(tree) + layer)) files.push_back(file);
  return files;
}

/// The lines of the files that match, as "file: line".
std::vector<std::string> lines_matching(const std::vector<std::string>& files, const std::regex& pattern) {
  std::vector<std::string> found;
  for (const std::string& file : files) {
    std::istringstream in(contents_of(file));
    for (std::string line; std::getline(in, line);)
      if (std::regex_search(line, pattern)) found.push_back(file + ": " + line);
  }
  return found;
}

std::string listed(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

TEST(Layering, TheCoreKnowsNothingOfRosAndPcl) {
  ASSERT_GT(core_files().size(), 50U);
  const std::regex include(
      R"(#\s*include\s*[<"](allan_lio/ros|ros|roscpp|rosbag|rosconsole|roslib|pcl\w*|std_msgs|sensor_msgs|nav_msgs|)"
      R"(geometry_msgs|tf2\w*|tf|nodelet|pluginlib|dynamic_reconfigure)/)");
  const std::vector<std::string> found = lines_matching(core_files(), include);
  EXPECT_TRUE(found.empty()) << listed(found);
  EXPECT_EQ(lines_matching(cpp_files("src/ros"), include).empty(), false) << "the pattern finds nothing at all";
}

TEST(Layering, TheCoreDoesNotPrintOrExit) {
  const std::regex prints(R"((std::(cout|cerr|clog)|\b(f|v|vf)?printf\s*\(|\b(puts|perror|abort|exit|assert)\s*\())");
  const std::vector<std::string> found = lines_matching(core_files(), prints);
  EXPECT_TRUE(found.empty()) << listed(found);
  EXPECT_EQ(lines_matching(cpp_files("src/tools"), prints).empty(), false) << "the pattern finds nothing at all";
}

TEST(Layering, NoHeaderUsesANamespaceForItsReaders) {
  std::vector<std::string> headers;
  for (const char* tree : {"include", "src", "test/support"})
    for (const std::string& file : cpp_files(tree))
      if (fs::path(file).extension() == ".h") headers.push_back(file);
  ASSERT_GT(headers.size(), 30U);
  const std::vector<std::string> found = lines_matching(headers, std::regex(R"(^\s*using\s+namespace\b)"));
  EXPECT_TRUE(found.empty()) << listed(found);
  for (const std::string& header : headers)
    EXPECT_NE(contents_of(header).find("\n#pragma once\n"), std::string::npos) << header;
}

TEST(Layering, EveryFileBeginsWithItsLicence) {
  const std::string licence =
      "// Copyright 2026 the allan_lio authors\n"
      "// SPDX-License-Identifier: BSD-3-Clause\n";
  int files = 0;
  for (const char* tree : {"include", "src", "test"})
    for (const std::string& file : cpp_files(tree)) {
      EXPECT_EQ(contents_of(file).rfind(licence, 0), 0U) << file;
      ++files;
    }
  EXPECT_GT(files, 100);
}

TEST(Layering, EveryScriptSaysWhatItIsFor) {
  for (const auto& entry : fs::directory_iterator(kRoot + "/scripts")) {
    const std::string name = entry.path().filename().string();
    if (name.front() == '.' || !entry.is_regular_file()) continue;
    const std::string text = contents_of(entry.path().string());
    const bool list = entry.path().extension() == ".txt";
    const std::regex header(list                                    ? R"(^# \w)"
                            : text.find("python") < text.find('\n') ? R"(^#!.*\n(#.*\n)*""".{20,})"
                                                                    : R"(^#!.*\n(#.*\n)+)");
    EXPECT_TRUE(std::regex_search(text, header, std::regex_constants::match_continuous)) << name;
    if (!list) {
      EXPECT_NE(entry.status().permissions() & fs::perms::owner_exec, fs::perms::none) << name << " is not executable";
    }
  }
}

}  // namespace
}  // namespace allan_lio
