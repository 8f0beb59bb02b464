// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace allan_lio {

struct Outcome {
  int status = -1;   ///< exit status; -1 for a child that a signal ended
  std::string text;  ///< what it printed, errors included
};

/// Runs a shell command to its end.
inline Outcome run_command(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(("{ " + command + "\n} 2>&1").c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start: " + command);
  char buffer[65536];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) outcome.text.append(buffer, n);
  const int status = pclose(pipe);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

/// Runs one of the package's executables: "lio_offline --bag ...". It finds the configurations of this source tree.
inline Outcome run_tool(const std::string& command_line) {
  return run_command("ROS_PACKAGE_PATH=" ALLAN_LIO_SOURCE_DIR ":$ROS_PACKAGE_PATH " ALLAN_LIO_BIN_DIR "/" +
                     command_line);
}

/// The bytes of a file.
inline std::string contents_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error(path + ": cannot be opened");
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

}  // namespace allan_lio
