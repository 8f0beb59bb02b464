// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <string>
#include <vector>

namespace allan_lio {

struct ProgramOutcome {
  int status = -1;     ///< exit status; -1 for a child that a signal ended
  std::string output;  ///< what it wrote to the standard output
  std::string errors;  ///< and to the standard error
};

/// Runs a program (words[0], a path or a name in $PATH) to its end, without a shell. It gets no signals blocked,
/// whatever the caller has. Where `stop` (may be null) turns true it is sent SIGTERM. Throws std::runtime_error if it
/// cannot be started.
ProgramOutcome run_program(const std::vector<std::string>& words, const std::atomic<bool>* stop = nullptr);

/// One word for a POSIX shell, whatever it holds.
std::string shell_quoted(const std::string& text);

}  // namespace allan_lio
